# Labels, contours and intensities from files: NIfTI (libnifti2), NRRD, MetaImage, GIPL, PNG (libpng), TIFF (libtiff), DICOM (DCMTK; GDCM
# through ITK for compressed pixels), masks, .cnt.
find_package(ITK 5 REQUIRED COMPONENTS ITKCommon ITKIOImageBase ITKIOGDCM)
find_package(ZLIB REQUIRED)
find_package(PNG REQUIRED)
find_package(TIFF REQUIRED)
find_package(DCMTK CONFIG REQUIRED)
# Debian's NIFTIConfig.cmake needs programs of another package (nifti-bin), so its library is looked for by name.
find_path(STACKMESH_NIFTI_INCLUDE nifti2_io.h PATH_SUFFIXES nifti REQUIRED)
find_library(STACKMESH_NIFTI nifti2 REQUIRED)
mark_as_advanced(STACKMESH_NIFTI_INCLUDE STACKMESH_NIFTI)
# Targets that a package imports are known in this folder only; what links to us from elsewhere needs them too.
get_property(image_imported DIRECTORY PROPERTY IMPORTED_TARGETS)
foreach(target IN LISTS image_imported)
  get_target_property(image_global ${target} IMPORTED_GLOBAL)
  if(NOT image_global)
    set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
  endif()
endforeach()
stackmesh_module(image COMPONENT Io
  SOURCES read_labels.cpp read_image.cpp read_contours.cpp read_label_table.cpp volume_file.cpp array_labels.cpp volume_header.cpp nifti_header.cpp nrrd_header.cpp metaimage_header.cpp data_files.cpp voxel_data.cpp
          slices.cpp png_file.cpp tiff_file.cpp
          masks.cpp palette.cpp file_names.cpp dicom_dataset.cpp dicom_text.cpp dicom_nesting.cpp dicom_grid.cpp
          dicom_segmentation.cpp dicom_series.cpp dicom_pixels.cpp read_structure_set.cpp segments.cpp slicer_segments.cpp text_header.cpp
  HEADERS read_labels.h read_label_table.h read_image.h read_contours.h read_structure_set.h dicom_file.h dicom_series.h
  USES base model
  PRIVATE $<BUILD_INTERFACE:${STACKMESH_NIFTI}> $<INSTALL_INTERFACE:nifti2> ZLIB::ZLIB PNG::PNG TIFF::TIFF DCMTK::dcmdata DCMTK::oflog DCMTK::ofstd)
target_include_directories(stackmesh_image SYSTEM PRIVATE ${STACKMESH_NIFTI_INCLUDE})
stackmesh_part(stackmesh-gdcm OF image SOURCES parts/gdcm_part.cpp PRIVATE ${ITK_LIBRARIES})
target_include_directories(stackmesh-gdcm SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")  # Debian's ITK headers know no compiler but GCC
  set_source_files_properties(image/parts/gdcm_part.cpp PROPERTIES COMPILE_OPTIONS "-U__clang__;-fgnuc-version=9.1.0")
endif()
