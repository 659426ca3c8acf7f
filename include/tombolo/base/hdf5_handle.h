// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <hdf5.h>

#include <utility>

namespace tombolo
{
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
