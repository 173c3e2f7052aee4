// The compiled half of the Python package `stackmesh`; stackmesh/__init__.py is the half that is called.
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <vector>

#include "arguments.h"
#include "base/error.h"
#include "input_labels.h"
#include "mesh_data.h"
#include "options.h"
#include "run/fem_run.h"
#include "run/mesh_run.h"
#include "run/validate_run.h"
#include "volume/find_worker.h"
#include "watched_run.h"

namespace stackmesh::python {
namespace {

namespace py = pybind11;

/// What is to be meshed: paths, or what is in memory.
struct Source {
  std::vector<std::string> paths;
  std::shared_ptr<const LabelVolume> volume;
  std::shared_ptr<const std::vector<LabelContours>> contours;
  std::string name;

  void give_to(InputOptions& input) const {
    input.paths = paths;
    input.volume = volume;
    input.contours = contours;
    input.memory_name = name;
  }
};

Source source_of_paths(std::vector<std::string> paths) {
  Source s;
  s.paths = std::move(paths);
  return s;
}

Source source_of_array(const py::array& labels, const py::object& affine, const py::object& spacing,
                       const py::dict& names, const std::string& name) {
  Source s;
  s.volume = volume_of_array(labels, affine, spacing, names, name);
  s.name = name;
  return s;
}

Source source_of_contours(const py::list& labels, const std::string& name) {
  Source s;
  s.contours = contours_of_lists(labels, name);
  s.name = name;
  return s;
}

/// @return the mesh and its report as JSON
std::pair<std::shared_ptr<MeshData>, std::string> mesh(const Source& source, const Arguments& arguments, bool surface,
                                                       bool full_report, const py::object& progress) {
  MeshRunOptions options = mesh_options(arguments, surface ? Target::surface : Target::volume);
  source.give_to(options.input);
  options.full_report = full_report;
  std::shared_ptr<MeshData> data;
  std::string report;
  run_watched(
      [&](Monitor& monitor) {
        report = to_json(run_mesh(options, monitor, {}, {},
                                  [&](MadeMesh made) { data = std::make_shared<MeshData>(std::move(made)); }));
      },
      progress);
  return {data, report};
}

std::string fem(const Source& source, const Arguments& arguments, const py::object& progress) {
  FemRunOptions options = fem_options(arguments);
  source.give_to(options.mesh.input);
  std::string report;
  run_watched([&](Monitor& monitor) { report = to_json(run_fem(options, monitor)); }, progress);
  return report;
}

std::string validate(const std::vector<std::string>& meshes, const Source* against, Arguments arguments,
                     const py::object& progress) {
  // so that the command takes what goes with it; replaced below
  if (against != nullptr) arguments.push_back({"against", "memory"});
  ValidateRunOptions options = validate_options(meshes, arguments);
  if (against != nullptr) against->give_to(*options.against);
  std::string report;
  run_watched(
      [&](Monitor& monitor) {
        const std::vector<RunReport> reports = run_validate(options, monitor);
        report = reports.size() == 1 ? to_json(reports[0]) : to_json(reports);
      },
      progress);
  return report;
}

std::string info(const Source& source, const std::string& spacing, const std::string& series, bool allow_outside) {
  app::InputArguments arguments;
  arguments.spacing = spacing;
  arguments.series = series;
  arguments.allow_outside = allow_outside;
  InputOptions input = arguments.options();
  source.give_to(input);
  std::string json;
  run_watched([&](Monitor&) { json = app::info_json(input); }, py::none());
  return json;
}

const char* name_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::usage:
      return "usage";
    case ErrorKind::input:
      return "input";
    case ErrorKind::no_result:
      return "no_result";
    case ErrorKind::output:
      return "output";
    case ErrorKind::outside_limits:
      return "outside_limits";
    case ErrorKind::cancelled:
      return "cancelled";
    case ErrorKind::internal:
      break;
  }
  return "internal";
}

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr raised) {
    try {
      if (raised) std::rethrow_exception(raised);
    } catch (const Error& e) {
      const py::object type = py::module_::import("stackmesh._error").attr("Error");
      PyErr_SetObject(type.ptr(), type(name_of(e.kind()), e.problem(), e.where(), e.mend()).ptr());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_stackmesh, m) {
  m.doc() = "The compiled half of stackmesh; see help(stackmesh).";
  m.attr("__version__") = STACKMESH_VERSION;
  translate_errors();
  py::class_<Source>(m, "Source", "What is to be meshed: files, an array or contours.")
      .def_static("of_paths", &source_of_paths)
      .def_static("of_array", &source_of_array)
      .def_static("of_contours", &source_of_contours);
  py::class_<MeshData, std::shared_ptr<MeshData>>(m, "MeshData", "A mesh; its arrays are views of it.")
      .def_property_readonly("has_tets", &MeshData::has_tets)
      .def_property_readonly("space", &MeshData::space)
      .def_property_readonly("names",
                             [](const MeshData& d) {
                               py::dict names;
                               for (const LabelInfo& l : d.labels()) names[py::int_(l.number)] = l.name;
                               return names;
                             })
      .def_property_readonly("colours",
                             [](const MeshData& d) {
                               py::dict colours;
                               for (const LabelInfo& l : d.labels())
                                 if (l.colour)
                                   colours[py::int_(l.number)] =
                                       py::make_tuple((*l.colour)[0], (*l.colour)[1], (*l.colour)[2]);
                               return colours;
                             })
      .def("points", &MeshData::points)
      .def("triangles", &MeshData::triangles)
      .def("triangle_labels", &MeshData::triangle_labels)
      .def("tets", &MeshData::tets)
      .def("tet_mids", &MeshData::tet_mids)
      .def("tet_labels", &MeshData::tet_labels)
      .def("wedges", &MeshData::wedges)
      .def("wedge_mids", &MeshData::wedge_mids)
      .def("wedge_labels", &MeshData::wedge_labels)
      .def("save", &MeshData::save, py::call_guard<py::gil_scoped_release>());
  m.def("keywords", [](const std::string& command) {
    py::list out;
    for (const Keyword& k : keywords_of(command)) out.append(py::make_tuple(k.name, k.kind, k.initial, k.description));
    return out;
  });
  m.def("worker", &worker::find_worker);
  m.def("mesh", &mesh);
  m.def("fem", &fem);
  m.def("validate", &validate);
  m.def("info", &info);
}

}  // namespace stackmesh::python
