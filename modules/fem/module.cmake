# A tetrahedral mesh to a solver model: sets, parts, skins, materials (constant or from intensities), a load case, contact.
stackmesh_module(fem COMPONENT Io
  SOURCES solver_names.cpp ordered_mesh.cpp boundary_faces.cpp boundary_patches.cpp uncut_mesh.cpp name_sets.cpp selection.cpp split_parts.cpp
          element_quality.cpp material_law.cpp read_law.cpp inside_voxels.cpp map_modulus.cpp assign_materials.cpp load_case.cpp
          join_parts.cpp read_load_case.cpp read_label_model.cpp face_integral.cpp check_supports.cpp lay_fibres.cpp recover_stress.cpp estimate_error.cpp
  HEADERS solver_names.h ordered_mesh.h name_sets.h element_quality.h material_law.h assign_materials.h load_case.h join_parts.h split_parts.h boundary_faces.h selection.h
          check_supports.h lay_fibres.h recover_stress.h estimate_error.h
  USES base model
  PRIVATE nlohmann_json::nlohmann_json)
