#include <tombolo/contact/read_vector.h>

#include <cmath>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  Tensor<1, dim> read_vector(const Section &section, const std::string &entry)
  {
    const std::vector<double> values = section.get_doubles(entry);
    if (values.size() != dim)
      section.fail(entry, "allowed are " + std::to_string(dim) + " numbers separated by commas.");
    Tensor<1, dim> result;
    for (unsigned int d = 0; d < dim; ++d)
    {
      if (!std::isfinite(values[d]))
        section.fail(entry, "allowed are finite numbers.");
      result[d] = values[d];
    }
    return result;
  }

  template <int dim>
  Tensor<1, dim> read_direction(const Section &section, const std::string &entry)
  {
    const auto result = read_vector<dim>(section, entry);
    const double length = result.norm();
    if (!(length > 0.) || !std::isfinite(length))
      section.fail(entry, "a direction needs a length above zero.");
    return result / length;
  }

  template Tensor<1, 2> read_vector<2>(const Section &, const std::string &);
  template Tensor<1, 3> read_vector<3>(const Section &, const std::string &);
  template Tensor<1, 2> read_direction<2>(const Section &, const std::string &);
  template Tensor<1, 3> read_direction<3>(const Section &, const std::string &);
} // namespace tombolo
