// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <type_traits>
#include <utility>

namespace tombolo
{
  /** The type in memory of the numbers, or characters, that the pointer points to. */
  template <typename Number>
  hid_t hdf5_type_of(const Number *)
  {
    if constexpr (std::is_same_v<Number, float>)
      return H5T_NATIVE_FLOAT;
    else if constexpr (std::is_same_v<Number, double>)
      return H5T_NATIVE_DOUBLE;
    else if constexpr (std::is_same_v<Number, std::int64_t>)
      return H5T_NATIVE_INT64;
    else if constexpr (std::is_same_v<Number, std::uint64_t>)
      return H5T_NATIVE_UINT64;
    else
    {
      static_assert(std::is_same_v<Number, char>);
      return H5T_NATIVE_CHAR;
    }
  }

  /** An identifier of HDF5 that is closed with its scope. */
  class Hdf5Handle
  {
  public:
    Hdf5Handle(const hid_t id, herr_t (*close)(hid_t)) : id(id), close(close) {}

    ~Hdf5Handle()
    {
      close_now();
    }

    Hdf5Handle(const Hdf5Handle &) = delete;
    Hdf5Handle &operator=(const Hdf5Handle &) = delete;

    operator hid_t() const
    {
      return id;
    }

    /** Whether that worked. */
    bool close_now()
    {
      const hid_t open = std::exchange(id, -1);
      return open < 0 || close(open) >= 0;
    }

  private:
    hid_t id;
    herr_t (*close)(hid_t);
  };
} // namespace tombolo
