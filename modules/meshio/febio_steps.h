#pragma once
// Part of the FEBio writer: what acts, step by step.
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "meshio/output_buffer.h"
#include "meshio/prepared_mesh.h"

namespace stackmesh {

/// One step stands in the sections Control, Boundary, Rigid and Loads; several in a section Step each. Step k runs from
/// time k - 1 to time k. FEBio takes a step's loads away at its end, so each step goes from the values of the one
/// before to its own: what stays the same is held, what is new grows from nothing, and what is over goes back to
/// nothing.
class FebioSteps {
 public:
  FebioSteps(OutputBuffer& out, const PreparedMesh& mesh);

  void control();
  void ground_nodes(const std::function<void(std::size_t number, Vec3 at)>& write);
  void node_sets(const std::function<void(const std::string& name, const std::vector<std::int32_t>& nodes)>& write);
  void discrete_sets();
  bool has_forces() const;
  void node_data();
  void acting();  ///< of the one step
  void springs();
  void further();  ///< the steps, where there are several
  void load_curves();

 private:
  struct Ground {
    std::string set;
    std::vector<const GroundSpring*> springs;
    std::size_t first = 0;  ///< number of its first ground node
  };
  void write_control(const LoadStep& step);
  void write_acting(std::size_t k);
  void boundary(std::size_t k);
  void rigid(std::size_t k);
  void loads(std::size_t k);
  void section(const char* name, bool& open);
  int curve(std::size_t k, double from, double to);
  bool has_friction() const;

  OutputBuffer& out_;
  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::vector<const LoadStep*> steps_;         // the static ones
  std::vector<std::array<double, 4>> curves_;  // times and values of the two ends
  std::vector<Ground> grounds_;
  int bcs_ = 0;
};

}  // namespace stackmesh
