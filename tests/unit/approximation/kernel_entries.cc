// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include "model_scene.h"

#include <tombolo/approximation/kernel.h>
#include <tombolo/base/input/entries.h>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace
{
  using namespace tombolo;

  double last_exponent = 0.;

  /** (1 - |r|)₊ (1 + |r|) to a power of the parameter file. */
  class PowerKernel : public Kernel
  {
  public:
    explicit PowerKernel(const Entries &e)
        : exponent(e.number("Exponent", "2", at_least(2.), "", "Of the kernel."))
    {
      if (!e.declares())
        last_exponent = exponent;
    }

    void evaluate(const std::size_t n, const double *const r, double *const w,
                  double *const dw) const override
    {
      for (std::size_t i = 0; i < n; ++i)
      {
        const double base = std::max(1. - r[i] * r[i], 0.);
        w[i] = std::pow(base, exponent);
        dw[i] = -2. * exponent * r[i] * std::pow(base, exponent - 1.);
      }
    }

  private:
    double exponent;
  };

  TOMBOLO_REGISTER(Kernel, PowerKernel, "power", "a kernel with an entry")

  std::string scene(const std::string &formulation)
  {
    return "set Dimension = 2\n"
           "set Parts = block\n"
           "set Materials = soft\n"
           "subsection Mesh\n"
           "  set Type = box\n"
           "  subsection box\n"
           "    set Upper corner = 1, 1\n"
           "    set Cells = 3, 3\n"
           "  end\n"
           "end\n"
           "subsection Part: block\n"
           "  set Cells = all\n"
           "  set Material = soft\n"
           "  set Formulation = " +
           formulation +
           "\n"
           "  subsection " +
           formulation +
           "\n"
           "    set Kernel = power\n"
           "    subsection power\n"
           "      set Exponent = 3.5\n"
           "    end\n"
           "  end\n"
           "end\n"
           "subsection Material: soft\n"
           "  set Model = elastic\n"
           "  subsection elastic\n"
           "    set Density = 1\n"
           "    set Young's modulus = 1\n"
           "    set Poisson's ratio = 0.3\n"
           "  end\n"
           "end\n";
  }
} // namespace

TEST(KernelEntries, AreReadFromTheSectionOfTheKernelByEachFormulationThatHasOne)
{
  for (const char *const formulation :
       {"momentum consistent particle", "smoothed particle", "smoothed cells"})
  {
    SCOPED_TRACE(formulation);
    last_exponent = 0.;
    const auto model = tombolo::testing::make_model<2>(scene(formulation));
    EXPECT_EQ(last_exponent, 3.5);
  }
}
