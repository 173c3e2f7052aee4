#pragma once
// The Nastran writer's steps: what acts, subcase by subcase.
#include <cstdint>
#include <string>

#include "meshio/fixed_fields.h"
#include "meshio/prepared_mesh.h"

namespace stackmesh {

/// One subcase a step. Of a deck with frequency steps those alone are written (SOL 103); with large displacements or
/// hyperelastic materials it is SOL 106.
class NastranSteps : FixedFields {
 public:
  NastranSteps(OutputBuffer& out, const PreparedMesh& mesh);

  int solution() const;
  void case_control();
  /// Points, springs, supports and loads; element and property numbers go on from these.
  void bulk(std::int64_t& number, std::int64_t& property);

 private:
  static std::int64_t id(std::size_t k, int kind) { return static_cast<std::int64_t>(100 * k) + kind; }
  bool moves(const LoadStep& step) const;
  bool has_load(const LoadStep& step) const { return step.has_loads() || moves(step); }
  void points(std::int64_t& number);
  void springs(std::int64_t& number, std::int64_t& property);
  void step(std::size_t k);
  void hold(std::int64_t set, const std::string& axes, const std::vector<std::int32_t>& nodes);
  void move(std::int64_t set, std::int32_t node, int axis, double value);
  void vector(const char* card, std::int64_t set, std::int64_t node, Vec3 value);
  void pressure(std::int64_t set, const Pressure& p);
  std::int32_t point_node(std::int32_t point) const { return static_cast<std::int32_t>(mesh_.points.size()) + point; }
  const std::vector<std::int32_t>& nodes_of(const std::string& set) const { return stackmesh::nodes_of(sets_, set); }

  const PreparedMesh& mesh_;
  const SolverSets& sets_;
  std::vector<const LoadStep*> steps_;  // those that are written
};

}  // namespace stackmesh
