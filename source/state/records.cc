// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/state/records.h>

namespace tombolo
{
  Records::Record &Records::Record::continues(const std::string &other)
  {
    continue_from =
        [read = serialize, condition = other.empty() ? name : other](StateArchive &archive)
    {
      if (archive.has(condition))
        read(archive);
    };
    return *this;
  }

  Records::Record &Records::archived(const std::string &name,
                                     std::function<void(StateArchive &)> serialize)
  {
    records.push_back(std::make_unique<Record>());
    records.back()->name = name;
    records.back()->serialize = std::move(serialize);
    return *records.back();
  }

  Records::Record &Records::list_of(const std::string &name, std::vector<double *> numbers,
                                    const bool are_shares)
  {
    Record &record = archived(name,
                              [numbers, are_shares, name](StateArchive &archive)
                              {
                                if (are_shares)
                                  return archive.sums(name, numbers);
                                std::vector<double> values;
                                for (const double *const number : numbers)
                                  values.push_back(*number);
                                archive(name, values);
                                if (values.size() != numbers.size())
                                  archive.fail("\"" + name + "\" does not have " +
                                               std::to_string(numbers.size()) + " values.");
                                for (std::size_t k = 0; k < values.size(); ++k)
                                  *numbers[k] = values[k];
                              });
    const auto kept = std::make_shared<std::vector<double>>(numbers.size());
    record.keep = [kept, numbers]
    {
      for (std::size_t k = 0; k < numbers.size(); ++k)
        (*kept)[k] = *numbers[k];
    };
    record.restore = [kept, numbers]
    {
      for (std::size_t k = 0; k < numbers.size(); ++k)
        *numbers[k] = (*kept)[k];
    };
    return record;
  }

  Records::Record &Records::nodal(const std::string &name, const unsigned int n_components,
                                  NodalVector &vector)
  {
    Record &record = archived(name, [&vector, n_components, name](StateArchive &archive)
                              { archive.nodal(name, n_components, vector); });
    const auto kept = std::make_shared<NodalVector>();
    record.keep = [kept, &vector]
    {
      if (vector.partition() == nullptr)
        return;
      kept->fit_to(vector.partition(), vector.quantity());
      kept->copy_from(vector);
    };
    record.restore = [kept, &vector]
    {
      if (kept->partition() != nullptr)
        vector.copy_from(*kept);
    };
    return record;
  }

  Records::Record &Records::group(const std::string &name, Records &other)
  {
    Record &record = archived(name,
                              [&other, name](StateArchive &archive)
                              {
                                const auto group = archive.group(name);
                                other.serialize(archive);
                              });
    record.continue_from = [&other, name](StateArchive &archive)
    {
      const auto group = archive.group(name);
      other.continue_from(archive);
    };
    record.keep = [&other] { other.keep(); };
    record.restore = [&other] { other.restore(); };
    return record;
  }

  Records &Records::group(const std::string &name)
  {
    const auto result = std::make_shared<Records>();
    Record &record = group(name, *result);
    record.keep = [result] { result->keep(); }; // which holds it
    return *result;
  }

  void Records::list(std::function<void(Records &)> contents)
  {
    const auto listed = [contents = std::move(contents)]
    {
      auto result = std::make_shared<Records>();
      contents(*result);
      return result;
    };
    Record &record =
        archived("", [listed](StateArchive &archive) { listed()->serialize(archive); });
    record.continue_from = [listed](StateArchive &archive) { listed()->continue_from(archive); };
    const auto kept = std::make_shared<std::shared_ptr<Records>>();
    record.keep = [listed, kept]
    {
      *kept = listed();
      (*kept)->keep();
    };
    record.restore = [kept] { (*kept)->restore(); };
  }

  void Records::on_reading(std::function<void()> action)
  {
    archived(
        [action = std::move(action)](StateArchive &archive)
        {
          if (archive.is_reading())
            action();
        });
  }

  void Records::on_division(std::function<void(StateArchive &)> action)
  {
    archived(
        [action = std::move(action)](StateArchive &archive)
        {
          if (archive.is_reading() && archive.division() != nullptr)
            action(archive);
        });
  }

  void Records::on_continuation(std::function<void()> action)
  {
    archived("", [](StateArchive &) {}).continue_from = [action = std::move(action)](StateArchive &)
    { action(); };
  }

  void Records::serialize(StateArchive &archive)
  {
    for (const auto &record : records)
      if (!record->is_optional || archive.has(record->name))
        record->serialize(archive);
  }

  void Records::continue_from(StateArchive &archive)
  {
    for (const auto &record : records)
      if (record->continue_from)
        record->continue_from(archive);
  }

  void Records::keep()
  {
    for (const auto &record : records)
      if (record->keep)
        record->keep();
  }

  void Records::restore()
  {
    for (const auto &record : records)
      if (record->restore)
        record->restore();
  }
} // namespace tombolo
