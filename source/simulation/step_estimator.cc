#include <tombolo/simulation/courant_estimator.h>
#include <tombolo/simulation/step_estimator.h>

#include <deal.II/base/mpi.h>

#include <array>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  StepLimit courant_limit(const Scene<dim> &scene)
  {
    StepLimit limit;
    for (const Part<dim> &part : scene.parts)
    {
      StepLimit of_part = part.formulation->courant_limit(scene.state.position);
      if (of_part.time_step < limit.time_step)
      {
        limit = of_part;
        limit.entity += " of part \"" + part.name + "\"";
      }
    }
    for (const auto &[time_step, entity, place] : Utilities::MPI::all_gather(
             scene.communicator, std::make_tuple(limit.time_step, limit.entity, limit.place)))
      if (time_step < limit.time_step)
      {
        limit.time_step = time_step;
        limit.entity = entity;
        limit.place = place;
      }
    // Equal limits on several ranks: the lowest rank speaks for all.
    for (const auto &[time_step, entity, place] : Utilities::MPI::all_gather(
             scene.communicator, std::make_tuple(limit.time_step, limit.entity, limit.place)))
    {
      limit.entity = entity;
      limit.place = place;
      break;
    }
    return limit;
  }

  template StepLimit courant_limit<2>(const Scene<2> &);
  template StepLimit courant_limit<3>(const Scene<3> &);

  template <int dim>
  CourantEstimator<dim>::CourantEstimator(const Section & /*section*/)
  {}

  template <int dim>
  void CourantEstimator<dim>::declare_parameters(ParameterHandler & /*handler*/)
  {}

  template <int dim>
  StepLimit CourantEstimator<dim>::estimate(Scene<dim> &scene)
  {
    return courant_limit(scene);
  }

  template <int dim>
  bool CourantEstimator<dim>::is_cheap() const
  {
    return true;
  }

  template class CourantEstimator<2>;
  template class CourantEstimator<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(StepEstimator, CourantEstimator, "paper",
                                  "eq. (41) of Pan et al. 2019: smallest length over wave speed")
} // namespace tombolo
