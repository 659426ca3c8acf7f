// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/state_archive.h>

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace tombolo
{
  /** Addresses of the components of two vectors in turn, for Records::sums(). */
  template <typename Vector, typename Other>
  std::vector<double *> interleaved(Vector &first, Other &second, const unsigned int n = 3)
  {
    std::vector<double *> result;
    for (unsigned int d = 0; d < n; ++d)
    {
      result.push_back(&first[d]);
      result.push_back(&second[d]);
    }
    return result;
  }

  template <typename Item>
  class NodeRecords;
  template <typename Item>
  class ItemRecords;

  /**
   * What an object keeps from step to step: its variables by name, listed once, where it is made.
   * Nothing else is needed for checkpoints, for trials of steps of bodies at rest, for meshes that
   * are divided in the run, and for a run that starts from the end of another:
   *
   *     records.value("time since filter", time_since_filter);
   *     records.sums("work", work, heat);
   *     records.at_nodes(nodes, springs).numbers("stiffness, depth", &Spring::stiffness,
   *                                              &Spring::depth);
   *
   * Variables are referred to: they must outlive the list at the same address. They are written and
   * read in the order of the list, so that a callback finds all before it read. Functions that
   * write or read are collective.
   */
  class Records
  {
  public:
    /** One of the list. */
    struct Record
    {
      std::string name;
      std::function<void(StateArchive &)> serialize, continue_from;
      std::function<void()> keep, restore;
      bool is_optional = false;

      /** A checkpoint may lack it: the variable then stays as it is. */
      Record &optional()
      {
        is_optional = true;
        return *this;
      }

      /** A run that starts from the end of another reads it from there, where that has it, or what
       * is called @p other. */
      Record &continues(const std::string &other = "");
    };

    Records() = default;
    Records(const Records &) = delete;
    Records &operator=(const Records &) = delete;

    /** What is the same on all ranks: a number, a text, a vector or a list of these. */
    template <typename Value>
    Record &value(const std::string &name, Value &variable)
    {
      Record &record =
          archived(name, [&variable, name](StateArchive &archive) { archive(name, variable); });
      keep_copy(record, variable);
      return record;
    }

    /** Several of these as one table: numbers, vectors, addresses of numbers. */
    template <typename... Numbers>
    Record &numbers(const std::string &name, Numbers &&...variables)
    {
      std::vector<double *> numbers;
      (append(numbers, variables), ...);
      return list_of(name, std::move(numbers), false);
    }

    /** The same of this rank's shares of sums over ranks. */
    template <typename... Shares>
    Record &sums(const std::string &name, Shares &&...variables)
    {
      std::vector<double *> shares;
      (append(shares, variables), ...);
      return list_of(name, std::move(shares), true);
    }

    /** The first @p n_components of owned nodes. Where nodes have come by a division, they have the
     * mean of those between which they lie. A vector without nodes receives those of the archive.
     */
    Record &nodal(const std::string &name, unsigned int n_components, NodalVector &vector);

    /** What items have, one for each of these owned nodes; its columns are listed by the result. A
     * node that has come by a division has zeros. Both lists are referred to, and the items are
     * sized on reading. */
    template <typename Item>
    NodeRecords<Item> at_nodes(const std::vector<unsigned int> &nodes, std::vector<Item> &items);

    /** @p n_components values of each of this rank's rows, contiguous (StateArchive::rows()). */
    template <typename Number>
    void rows(const std::string &name, const unsigned int n_components, std::vector<Number> &values)
    {
      archived(
          [name, n_components, &values](StateArchive &archive)
          {
            std::vector<double> numbers(values.begin(), values.end());
            archive.rows(name, n_components, numbers);
            values.resize(numbers.size());
            std::transform(numbers.begin(), numbers.end(), values.begin(),
                           [](const double number) { return static_cast<Number>(number); });
          });
    }

    /** A list of items, the same on all ranks; its columns are listed by the result. */
    template <typename Item>
    ItemRecords<Item> items(std::vector<Item> &items);

    /** A list of its own, whose names belong to a group; valid as long as this. */
    Records &group(const std::string &name);
    /** That of another object, which must outlive this. */
    Record &group(const std::string &name, Records &other);

    /** What is listed anew each time, since it depends on what is there. */
    void list(std::function<void(Records &)> contents);

    /** Tables of a form of their own, which are not part of trials. */
    Record &archived(const std::string &name, std::function<void(StateArchive &)> serialize);
    void archived(std::function<void(StateArchive &)> serialize)
    {
      archived("", std::move(serialize));
    }

    /** What follows from what is read before it in the list, or has to be done for what is after
     * it. */
    void on_reading(std::function<void()> action);
    /** The same where the mesh has been divided (StateArchive::division()), with what the archive
     * has in the present group. */
    void on_division(std::function<void(StateArchive &)> action);
    /** The same where a run starts from the end of another. */
    void on_continuation(std::function<void()> action);

    /** What follows when the stage to which the list belongs has been read: complete(). */
    void on_completion(std::function<void()> action)
    {
      completions.push_back(std::move(action));
    }

    /** Writes to a checkpoint, or reads from it. */
    void serialize(StateArchive &archive);

    /** Does what follows from all that was read. */
    void complete() const
    {
      for (const auto &action : completions)
        action();
    }

    /** Reads from the end of another run what continues and is there. */
    void continue_from(StateArchive &archive);

    /** Stores the values of all that is listed, and restores them: any number of times. */
    void keep();
    void restore();

  private:
    template <typename Item>
    friend class NodeRecords;

    template <typename Variable>
    static void keep_copy(Record &record, Variable &variable)
    {
      const auto kept = std::make_shared<Variable>();
      record.keep = [kept, &variable] { *kept = variable; };
      record.restore = [kept, &variable] { variable = *kept; };
    }

    static void append(std::vector<double *> &addresses, double &variable)
    {
      addresses.push_back(&variable);
    }
    static void append(std::vector<double *> &addresses, const std::vector<double *> &others)
    {
      addresses.insert(addresses.end(), others.begin(), others.end());
    }
    template <std::size_t n>
    static void append(std::vector<double *> &addresses, std::array<double, n> &vector)
    {
      for (double &component : vector)
        addresses.push_back(&component);
    }
    Record &list_of(const std::string &name, std::vector<double *> numbers, bool are_shares);

    std::vector<std::unique_ptr<Record>> records;
    std::vector<std::function<void()>> completions;
  };

  /** Lists columns of items at nodes, for Records::at_nodes(). */
  template <typename Item>
  class NodeRecords
  {
  public:
    NodeRecords(Records &records, const std::vector<unsigned int> &nodes, std::vector<Item> &items)
        : records(records), nodes(nodes), items(items)
    {
      Records::keep_copy(records.archived("", [](StateArchive &) {}), items);
    }

    /** Up to three numbers: members of an item, or functions that return them. */
    template <typename... Members>
    NodeRecords &numbers(const std::string &name, const Members... members)
    {
      static_assert(sizeof...(Members) <= 3);
      return column(
          name,
          [=](Item &item, std::array<double, 3> &values)
          {
            unsigned int c = 0;
            ((values[c++] = static_cast<double>(std::invoke(members, item))), ...);
          },
          [=](Item &item, const std::array<double, 3> &values)
          {
            unsigned int c = 0;
            ((assign(std::invoke(members, item), values[c++])), ...);
          });
    }

    /** A vector: a member of an item, or a function that returns it. */
    template <typename Member>
    NodeRecords &vector(const std::string &name, const Member member)
    {
      return column(
          name,
          [=](Item &item, std::array<double, 3> &values)
          {
            auto &components = std::invoke(member, item);
            std::copy_n(&components[0], n_components(components), values.begin());
          },
          [=](Item &item, const std::array<double, 3> &values)
          {
            auto &components = std::invoke(member, item);
            std::copy_n(values.begin(), n_components(components), &components[0]);
          });
    }

    /** The last column is that of a field which is @p field at nodes without an item: a node that
     * has come by a division has the mean of those between which it lies. */
    NodeRecords &samples_field(const NodalVector &field)
    {
      *elsewhere = &field;
      return *this;
    }

    /** A run that starts from the end of another reads the columns so far from there, where that
     * has them, or what is called @p other. */
    NodeRecords &continues(const std::string &other = "")
    {
      for (Records::Record *const record : columns)
        record->continues(other);
      return *this;
    }

  private:
    template <typename Number>
    static void assign(Number &variable, const double value)
    {
      if constexpr (std::is_same_v<Number, bool>)
        variable = value > 0.;
      else
        variable = static_cast<Number>(value);
    }
    template <int dim>
    static constexpr unsigned int n_components(const dealii::Tensor<1, dim> &)
    {
      return dim;
    }
    template <std::size_t n>
    static constexpr unsigned int n_components(const std::array<double, n> &)
    {
      return n;
    }

    template <typename Get, typename Set>
    NodeRecords &column(const std::string &name, const Get &get, const Set &set)
    {
      elsewhere = std::make_shared<const NodalVector *>(nullptr);
      columns.push_back(&records.archived(
          name,
          [&nodes = nodes, &items = items, field = elsewhere, name, get, set](StateArchive &archive)
          {
            std::vector<std::array<double, 3>> values(items.size());
            for (std::size_t k = 0; k < items.size(); ++k)
              get(items[k], values[k]);
            archive.nodal(name, nodes, values, *field);
            if (!archive.is_reading())
              return;
            items.resize(nodes.size());
            for (std::size_t k = 0; k < items.size(); ++k)
              set(items[k], values[k]);
          }));
      return *this;
    }

    Records &records;
    const std::vector<unsigned int> &nodes;
    std::vector<Item> &items;
    std::vector<Records::Record *> columns;
    std::shared_ptr<const NodalVector *> elsewhere;
  };

  template <typename Item>
  NodeRecords<Item> Records::at_nodes(const std::vector<unsigned int> &nodes,
                                      std::vector<Item> &items)
  {
    return {*this, nodes, items};
  }

  /** Lists columns of a list of items, for Records::items(). */
  template <typename Item>
  class ItemRecords
  {
  public:
    ItemRecords(Records &records, std::vector<Item> &items) : records(records), items(items) {}

    /** A number or a text: a member of an item. */
    template <typename Value>
    ItemRecords &column(const std::string &name, Value Item::*const member)
    {
      using Stored = std::conditional_t<std::is_unsigned_v<Value>, std::uint64_t, Value>;
      records.archived(name,
                       [&items = items, is_first = is_first, name, member](StateArchive &archive)
                       {
                         std::vector<Stored> values;
                         for (const Item &item : items)
                           values.push_back(item.*member);
                         archive(name, values);
                         size(items, is_first, name, values.size(), archive);
                         for (std::size_t k = 0; k < items.size(); ++k)
                           items[k].*member = static_cast<Value>(values[k]);
                       });
      is_first = false;
      return *this;
    }

    /** Numbers, as many of each item, whose addresses @p numbers_of returns. */
    template <typename NumbersOf>
    ItemRecords &numbers(const std::string &name, const NumbersOf &numbers_of)
    {
      records.archived(
          name,
          [&items = items, is_first = is_first, name, numbers_of](StateArchive &archive)
          {
            std::vector<double> values;
            for (Item &item : items)
              for (const double *const number : numbers_of(item))
                values.push_back(*number);
            archive(name, values);
            Item any;
            const std::size_t n = numbers_of(any).size();
            if (values.size() % n != 0)
              archive.fail("\"" + name + "\" does not have " + std::to_string(n) +
                           " values for each of its items.");
            size(items, is_first, name, values.size() / n, archive);
            for (std::size_t k = 0, next = 0; k < items.size(); ++k)
              for (double *const number : numbers_of(items[k]))
                *number = values[next++];
          });
      is_first = false;
      return *this;
    }

  private:
    static void size(std::vector<Item> &items, const bool is_first, const std::string &name,
                     const std::size_t n, const StateArchive &archive)
    {
      if (is_first)
        items.resize(n);
      else if (n != items.size())
        archive.fail("\"" + name + "\" is of " + std::to_string(n) +
                     " items, and what is before it of " + std::to_string(items.size()) + ".");
    }

    Records &records;
    std::vector<Item> &items;
    bool is_first = true;
  };

  template <typename Item>
  ItemRecords<Item> Records::items(std::vector<Item> &items)
  {
    return {*this, items};
  }
} // namespace tombolo
