// SPDX-License-Identifier: LGPL-2.1-or-later
#include <gtest/gtest.h>

#include <tombolo/formulations/elements/fully_integrated_hexahedron.h>
#include <tombolo/formulations/elements/lagrange_hexahedron.h>
#include <tombolo/formulations/elements/one_point_hexahedron.h>

#include <cmath>
#include <random>

/** Element types by themselves, on eight random cells. */
namespace tombolo
{
  namespace
  {
    /** A material of given moduli, without an update. */
    class Moduli : public Material
    {
    public:
      Moduli(const double bulk, const double shear) : bulk(bulk), shear(shear) {}
      double density() const override
      {
        return 3.;
      }
      double bulk_modulus() const override
      {
        return bulk;
      }
      double shear_modulus() const override
      {
        return shear;
      }
      void update_stress(MaterialBatch &) const override {}

    private:
      double bulk, shear;
    };

    template <int tested_dim, typename TestedElement>
    struct Case
    {
      static constexpr int dim = tested_dim;
      using Element = TestedElement;

      static Element make()
      {
        if constexpr (std::is_same_v<Element, OnePointHexahedron<dim>>)
          return Element(0.05);
        else
          return Element();
      }
    };

    /** Values at the nodes of eight cells. */
    template <int dim, typename Element>
    struct Field
    {
      Lanes values[Element::n_nodes][dim];

      template <typename Function>
      explicit Field(const Function &function)
      {
        for (unsigned int k = 0; k < Element::n_nodes; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            values[k][d] = Lanes([&](const auto lane) { return function(k, d, lane); });
      }
    };

    /** The element evaluated at one field of positions and one of velocities, with its elastic
     * force. */
    template <int dim, typename Element>
    struct Evaluation
    {
      using Nodal = Field<dim, Element>;
      typename Element::Work work;
      Lanes volume[Element::n_points];
      Matrix3<Lanes> gradient[Element::n_points];
      Lanes stress[Element::n_points][6]; // times volume
      Nodal force{[](auto...) { return 0.; }};

      Evaluation(Element element, const Nodal &initial, const Nodal &x, const Nodal &v,
                 const Material &material)
      {
        element.set_material(material);
        const std::vector<FieldDescription> fields = element.variables();
        std::vector<std::vector<double>> storage;
        std::vector<double *> variables;
        for (const FieldDescription &field : fields)
          for (unsigned int c = 0; c < field.n_components; ++c)
            storage.emplace_back(n_lanes * Element::n_points, 0.);
        for (auto &values : storage)
          variables.push_back(values.data());
        element.evaluate(initial.values, v.values, work, volume, gradient);
        element.initialize_variables(work, variables.data());

        element.evaluate(x.values, v.values, work, volume, gradient);
        element.linearize(work, 1., const_cast<const double *const *>(variables.data()));
        const double shear = material.shear_modulus();
        const double lambda = material.bulk_modulus() - 2. / 3. * shear;
        for (unsigned int q = 0; q < Element::n_points; ++q)
        {
          const Matrix3<Lanes> &l = gradient[q];
          const Lanes trace = l(0, 0) + l(1, 1) + l(2, 2);
          for (unsigned int d = 0; d < 3; ++d)
          {
            const unsigned int j = (d + 1) % 3, k = (d + 2) % 3;
            stress[q][d] = volume[q] * (lambda * trace + 2. * shear * l(d, d));
            stress[q][3 + d] = volume[q] * shear * (l(j, k) + l(k, j));
          }
        }
        element.integrate(work, stress, force.values);
      }

      Lanes power(const Nodal &v) const
      {
        Lanes sum = 0.;
        for (unsigned int k = 0; k < Element::n_nodes; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            sum += force.values[k][d] * v.values[k][d];
        return sum;
      }

      Lanes stress_power() const
      {
        Lanes sum = 0.;
        for (unsigned int q = 0; q < Element::n_points; ++q)
          for (unsigned int d = 0; d < 3; ++d)
          {
            const unsigned int j = (d + 1) % 3, k = (d + 2) % 3;
            sum += stress[q][d] * gradient[q](d, d);
            sum += stress[q][3 + d] * (gradient[q](j, k) + gradient[q](k, j));
          }
        return sum;
      }
    };

    /** Node k of a regular cell with corners at ±1. */
    template <int dim, typename Element>
    dealii::Point<dim> reference_node(const unsigned int k)
    {
      if constexpr (Element::degree == 1)
      {
        dealii::Point<dim> point;
        for (unsigned int d = 0; d < dim; ++d)
          point[d] = ((k >> d) & 1u) != 0 ? 1. : -1.;
        return point;
      }
      else
        return Element::reference_points()[k];
    }

    template <typename TestedCase>
    class ElementTypes : public ::testing::Test
    {
    public:
      static constexpr int dim = TestedCase::dim;
      using Element = typename TestedCase::Element;
      using Nodal = Field<dim, Element>;

      double random()
      {
        return std::uniform_real_distribution<double>(-1., 1.)(generator);
      }
      Nodal random_velocity()
      {
        return Nodal([&](auto...) { return random(); });
      }
      Nodal distorted(const double amount)
      {
        return Nodal([&](const unsigned int k, const unsigned int d, auto)
                     { return reference_node<dim, Element>(k)[d] + amount * random(); });
      }

    private:
      std::mt19937 generator{42};
    };

    using Cases = ::testing::Types<
        Case<2, OnePointHexahedron<2>>, Case<3, OnePointHexahedron<3>>,
        Case<2, FullyIntegratedHexahedron<2, true>>, Case<3, FullyIntegratedHexahedron<3, true>>,
        Case<2, FullyIntegratedHexahedron<2, false>>, Case<3, FullyIntegratedHexahedron<3, false>>,
        Case<2, LagrangeHexahedron<2, 2>>, Case<3, LagrangeHexahedron<3, 2>>,
        Case<2, LagrangeHexahedron<2, 3>>, Case<3, LagrangeHexahedron<3, 3>>>;
    TYPED_TEST_SUITE(ElementTypes, Cases);

    TYPED_TEST(ElementTypes, the_volume_changes_by_the_trace_of_the_gradient)
    {
      constexpr int dim = TestFixture::dim;
      using Element = typename TestFixture::Element;
      const auto x = this->distorted(0.05);
      const auto v = this->random_velocity();
      const Moduli material(2., 1.);
      const double step = 1e-4;
      Lanes volume[2];
      for (const unsigned int side : {0u, 1u})
      {
        auto moved = x;
        for (unsigned int k = 0; k < Element::n_nodes; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            moved.values[k][d] += (side == 1 ? step : -step) * v.values[k][d];
        const Evaluation<dim, Element> evaluation(TypeParam::make(), x, moved, v, material);
        volume[side] = 0.;
        for (const Lanes &point_volume : evaluation.volume)
          volume[side] += point_volume;
      }
      const Evaluation<dim, Element> evaluation(TypeParam::make(), x, x, v, material);
      Lanes rate = 0.;
      for (unsigned int q = 0; q < Element::n_points; ++q)
        rate +=
            evaluation.volume[q] * (evaluation.gradient[q](0, 0) + evaluation.gradient[q](1, 1) +
                                    evaluation.gradient[q](2, 2));
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        EXPECT_NEAR((volume[1][lane] - volume[0][lane]) / (2. * step), rate[lane],
                    1e-6 * (1. + std::abs(rate[lane])));
    }

    TYPED_TEST(ElementTypes, the_gradient_of_a_linear_velocity_is_exact_at_every_point)
    {
      constexpr int dim = TestFixture::dim;
      using Element = typename TestFixture::Element;
      const auto x = this->distorted(0.05);
      Matrix3<double> exact = zero_matrix<double>();
      for (unsigned int i = 0; i < dim; ++i)
        for (unsigned int j = 0; j < dim; ++j)
          exact(i, j) = this->random();
      auto v = x;
      for (unsigned int k = 0; k < Element::n_nodes; ++k)
        for (unsigned int i = 0; i < dim; ++i)
        {
          v.values[k][i] = 5.;
          for (unsigned int j = 0; j < dim; ++j)
            v.values[k][i] += exact(i, j) * x.values[k][j];
        }
      const Moduli material(2., 1.);
      const Evaluation<dim, Element> evaluation(TypeParam::make(), x, x, v, material);
      for (unsigned int q = 0; q < Element::n_points; ++q)
        for (unsigned int i = 0; i < 9; ++i)
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            ASSERT_NEAR(evaluation.gradient[q].entry[i][lane], exact.entry[i], 1e-12);
      // A linear field has no hourglass force either: all power is that of the stress.
      const Lanes power = evaluation.power(v), expected = evaluation.stress_power();
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
        EXPECT_NEAR(power[lane], expected[lane], 1e-12 * expected[lane]);
    }

    TYPED_TEST(ElementTypes, the_force_is_the_transpose_of_the_gradient)
    {
      constexpr int dim = TestFixture::dim;
      using Element = typename TestFixture::Element;
      const auto initial = this->distorted(0.05);
      const auto x = this->distorted(0.05);
      const auto v = this->random_velocity();
      const auto w = this->random_velocity();
      const Moduli material(2., 1.);
      const Evaluation<dim, Element> evaluation_v(TypeParam::make(), initial, x, v, material);
      const Evaluation<dim, Element> evaluation_w(TypeParam::make(), initial, x, w, material);
      // With hourglass forces the power is larger than that of the stress.
      const Lanes surplus = evaluation_v.power(v) - evaluation_v.stress_power();
      const Lanes difference = evaluation_v.power(w) - evaluation_w.power(v);
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        const double scale = evaluation_v.stress_power()[lane];
        if (Element::n_points == 1)
        {
          EXPECT_GT(surplus[lane], 1e-3 * scale);
        }
        else
        {
          EXPECT_NEAR(surplus[lane], 0., 1e-12 * scale);
        }
        EXPECT_NEAR(difference[lane], 0., 1e-11 * scale);
      }
    }

    TYPED_TEST(ElementTypes, only_rigid_motion_has_no_stiffness)
    {
      constexpr int dim = TestFixture::dim;
      using Element = typename TestFixture::Element;
      // Every single hourglass mode of the corners, on a distorted cell, is resisted.
      const auto x = this->distorted(0.05);
      const Moduli material(2., 1.);
      for (unsigned int mode = 3; mode < (1u << dim); ++mode)
        if (is_hourglass_mode(mode))
          for (unsigned int direction = 0; direction < dim; ++direction)
          {
            const typename TestFixture::Nodal v(
                [&](const unsigned int k, const unsigned int d, auto)
                {
                  double value = d == direction ? 1. : 0.;
                  for (unsigned int a = 0; a < dim; ++a)
                    if (((mode >> a) & 1u) != 0)
                      value *= reference_node<dim, Element>(k)[a];
                  return value;
                });
            const Evaluation<dim, Element> evaluation(TypeParam::make(), x, x, v, material);
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              EXPECT_GT(evaluation.power(v)[lane], 0.1) << "mode " << mode;
          }
    }

    /** Stiffness, divided by the shear modulus, of u_x = ξη: what bending is for degree 1. */
    template <int dim, typename Element>
    double bending_stiffness(const Element &element, const double poisson)
    {
      const Moduli material(2. * (1. + poisson) / (3. * (1. - 2. * poisson)), 1.);
      const Field<dim, Element> x([](const unsigned int k, const unsigned int d, auto)
                                  { return reference_node<dim, Element>(k)[d]; });
      const Field<dim, Element> v(
          [](const unsigned int k, const unsigned int d, auto)
          {
            const dealii::Point<dim> node = reference_node<dim, Element>(k);
            return d == 0 ? node[0] * node[1] : 0.;
          });
      return Evaluation<dim, Element>(element, x, x, v, material).power(v)[0];
    }

    template <int dim>
    void check_bending()
    {
      // Per unit of ∫ dV = 2^dim; in bending the exact stiffness stays of the order of the shear
      // modulus as ν → ½, without mean dilatation it grows as the bulk modulus does.
      const double volume = 1 << dim;
      const double mean = bending_stiffness<dim>(FullyIntegratedHexahedron<dim, true>(), 0.4999);
      const double full = bending_stiffness<dim>(FullyIntegratedHexahedron<dim, false>(), 0.4999);
      EXPECT_LT(mean, 2. * volume);
      EXPECT_GT(mean, 0.2 * volume);
      EXPECT_GT(full, 500. * volume);
      EXPECT_NEAR(bending_stiffness<dim>(FullyIntegratedHexahedron<dim, true>(), 0.3) / mean, 1.,
                  0.2);
    }

    TEST(BBar, bending_does_not_lock_where_the_volume_is_kept)
    {
      check_bending<2>();
      check_bending<3>();
    }

    template <int dim>
    void check_hourglass()
    {
      using Element = OnePointHexahedron<dim>;
      const Moduli material(2., 1.);
      const double modulus = 2. + 4. / 3.;
      const Field<dim, Element> x([](const unsigned int k, const unsigned int d, auto)
                                  { return reference_node<dim, Element>(k)[d]; });
      const Field<dim, Element> v(
          [](const unsigned int k, const unsigned int d, auto)
          {
            const dealii::Point<dim> node = reference_node<dim, Element>(k);
            return d == 0 ? node[0] * node[1] : 0.;
          });
      // On a cube of edge h = 2: Σ B² = h⁴ 3/2 (2 h² in the plane), q̇ = √2^dim.
      const double stiffness =
          dim == 3 ? 0.5 * 0.05 * modulus * 1.5 * 2. : 0.5 * 0.05 * modulus * 2.;
      const double power_of_stiffness =
          Evaluation<dim, Element>(Element(0.05), x, x, v, material).power(v)[0];
      EXPECT_NEAR(power_of_stiffness, stiffness * (1 << dim), 1e-12);
      EXPECT_EQ((Evaluation<dim, Element>(Element(0.), x, x, v, material).power(v)[0]), 0.);
    }

    TEST(Hourglass, coefficients_are_those_of_flanagan_and_belytschko_on_a_cube)
    {
      check_hourglass<2>();
      check_hourglass<3>();
    }
  } // namespace
} // namespace tombolo
