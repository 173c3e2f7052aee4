// CGAL's isotropic remeshing of a closed surface, as users put it between a smoothed surface and TetGen: what
// apps/make_accuracy.py compares with. bench_remesh_peer IN.off OUT.off EDGE_MM
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Surface_mesh.h>

#include <cstdlib>
#include <fstream>
#include <iostream>

int main(int argc, char** argv) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  namespace pmp = CGAL::Polygon_mesh_processing;
  if (argc != 4) {
    std::cerr << "usage: bench_remesh_peer IN.off OUT.off EDGE_MM\n";
    return 2;
  }
  Mesh mesh;
  std::ifstream in(argv[1]);
  if (!(in >> mesh)) return 3;
  pmp::isotropic_remeshing(faces(mesh), std::atof(argv[3]), mesh,
                           pmp::parameters::number_of_iterations(5).number_of_relaxation_steps(3));
  mesh.collect_garbage();
  std::ofstream out(argv[2]);
  out.precision(17);
  out << mesh;
  return out ? 0 : 5;
}
