// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/materials/flow_stress.h>
#include <tombolo/materials/material.h>
#include <tombolo/materials/thermal_properties.h>
#include <tombolo/state/material_points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    /** A plug-in of kind Interface made from the entries of its section, and where it is a material
     * with those of the section "Heat" beside it. */
    template <typename Interface>
    std::unique_ptr<Interface> make_plugin(const std::string &name, const std::string &entries,
                                           const std::string &heat = "")
    {
      Parameters &parameters = *new Parameters(MPI_COMM_SELF); // plug-ins may keep their section
      static std::vector<std::unique_ptr<Parameters>> kept;
      kept.emplace_back(&parameters);
      parameters.read_text("subsection " + name + "\n" + entries + "end\n", "test.prm");
      if (!heat.empty())
        parameters.read_text("subsection Heat\n" + heat + "end\n", "heat.prm");
      Registry<Interface>::instance().declare_all(parameters.handler());
      parameters.handler().enter_subsection("Heat");
      declare<ThermalProperties>(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.assign();
      auto result = Registry<Interface>::instance().create(name, parameters.section(name));
      parameters.refuse_unused();
      return result;
    }

    /** A symmetric tensor. */
    struct Tensor6
    {
      Tensor6(const double xx = 0., const double yy = 0., const double zz = 0.,
              const double yz = 0., const double xz = 0., const double xy = 0.)
          : entry{xx, yy, zz, yz, xz, xy}
      {}
      double &operator[](const unsigned int c)
      {
        return entry[c];
      }
      double operator[](const unsigned int c) const
      {
        return entry[c];
      }
      double entry[6];
    };

    inline double contract(const Tensor6 &a, const Tensor6 &b)
    {
      return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] +
             2. * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
    }

    inline double effective_stress(const Tensor6 &stress)
    {
      Tensor6 s = stress;
      const double mean = (s[0] + s[1] + s[2]) / 3.;
      for (unsigned int c = 0; c < 3; ++c)
        s[c] -= mean;
      return std::sqrt(1.5 * contract(s, s));
    }

    /** Points of one material, driven by strain increments. */
    class Points
    {
    public:
      Points(const Material &material, const unsigned int n = n_lanes) : material(material), n(n)
      {
        points.reinit(n, material.internal_variables());
        for (auto &component : strain)
          component.resize(points.padded_size());
      }

      double &value(const std::string &field, const unsigned int point)
      {
        const unsigned int f = points.find_field(field);
        AssertThrow(f < points.fields().size(), dealii::ExcMessage("no field " + field));
        return points.component(f, 0)[point];
      }

      Tensor6 stress(const unsigned int point = 0)
      {
        Tensor6 result;
        for (unsigned int c = 0; c < 6; ++c)
          result[c] = points.component(MaterialPoints::stress, c)[point];
        return result;
      }

      /** A tensor that the material keeps. */
      Tensor6 tensor(const std::string &field, const unsigned int point = 0)
      {
        Tensor6 result;
        for (unsigned int c = 0; c < 6; ++c)
          result[c] = points.component(points.find_field(field), c)[point];
        return result;
      }

      void set_stress(const unsigned int point, const Tensor6 &stress)
      {
        for (unsigned int c = 0; c < 6; ++c)
          points.component(MaterialPoints::stress, c)[point] = stress[c];
      }

      /** The increment that advance() applies. */
      void set_increment(const unsigned int point, const Tensor6 &increment)
      {
        for (unsigned int c = 0; c < 6; ++c)
          strain[c][point] = increment[c];
      }

      /** From now on the batches have temperatures, at all points this one. */
      void set_temperature(const double value)
      {
        temperature.assign(points.padded_size(), value);
        temperature_increment.assign(points.padded_size(), 0.);
      }

      /** A change of the temperature that the next advance() uses. */
      void add_temperature(const unsigned int point, const double change)
      {
        temperature[point] += change;
        temperature_increment[point] += change;
      }

      /** A step; the volumes follow the strain. */
      void advance(const double time_increment)
      {
        MaterialBatch batch;
        batch.n = points.padded_size();
        batch.time_increment = time_increment;
        double *const ratio = points.component(MaterialPoints::volume_ratio, 0);
        for (unsigned int i = 0; i < batch.n; ++i)
          ratio[i] *= std::exp(strain[0][i] + strain[1][i] + strain[2][i]);
        batch.relative_volume = ratio;
        batch.temperature = temperature.empty() ? nullptr : temperature.data();
        batch.temperature_increment = temperature.empty() ? nullptr : temperature_increment.data();
        for (unsigned int c = 0; c < 6; ++c)
        {
          batch.stress[c] = points.component(MaterialPoints::stress, c);
          batch.strain_increment[c] = strain[c].data();
        }
        for (unsigned int f = MaterialPoints::n_standard_fields; f < points.fields().size(); ++f)
          for (unsigned int c = 0; c < points.fields()[f].n_components; ++c)
            batch.internal_variables.push_back(points.component(f, c));
        material.update_stress(batch);
        std::fill(temperature_increment.begin(), temperature_increment.end(), 0.);
      }

      /** The same increment at all points. */
      void advance(const Tensor6 &increment, const double time_increment)
      {
        for (unsigned int i = 0; i < n; ++i)
          set_increment(i, increment);
        advance(time_increment);
      }

      /** Per unit of initial volume. */
      double elastic_energy(const unsigned int point = 0)
      {
        std::vector<double> density(points.padded_size());
        const double *stress[6];
        for (unsigned int c = 0; c < 6; ++c)
          stress[c] = points.component(MaterialPoints::stress, c);
        material.elastic_energy_density(points.padded_size(), stress,
                                        temperature.empty() ? nullptr : temperature.data(),
                                        density.data());
        return density[point];
      }

      MaterialPoints points;
      std::vector<double> temperature; ///< of the points; empty in scenes without heat

    private:
      const Material &material;
      unsigned int n;
      std::array<std::vector<double>, 6> strain;
      std::vector<double> temperature_increment;
    };

    /** OFHC copper, in SI units, with the entries of Johnson and Cook. */
    inline std::string copper(const std::string &thermal_exponent = "1.09")
    {
      return "set Density = 8960\nset Young's modulus = 124e9\nset Poisson's ratio = 0.34\n"
             "set Flow stress = johnson cook\nset Taylor-Quinney coefficient = 0.9\n"
             "set Specific heat capacity = 383\nset Initial temperature = 298\n"
             "subsection johnson cook\nset Yield stress = 65e6\n"
             "set Hardening coefficient = 356e6\nset Hardening exponent = 0.37\n"
             "set Rate coefficient = 0.013\nset Reference rate = 1\nset Thermal exponent = " +
             thermal_exponent +
             "\nset Melting temperature = 1356\nset Reference temperature = 298\nend\n";
    }

    inline std::string linear(const std::string &yield, const std::string &modulus)
    {
      return "set Density = 2\nset Young's modulus = 260\nset Poisson's ratio = 0.3\n"
             "set Flow stress = linear hardening\nsubsection linear hardening\n"
             "set Yield stress = " +
             yield + "\nset Hardening modulus = " + modulus + "\nend\n";
    }
  } // namespace testing
} // namespace tombolo
