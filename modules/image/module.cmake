# Labels, contours and intensities from files: NIfTI, NRRD, MetaImage, GIPL (ITK), DICOM (DCMTK, GDCM through ITK), PNG/TIFF
# slices (OpenCV), masks, .cnt.
find_package(ITK 5 REQUIRED COMPONENTS
  ITKCommon ITKIOImageBase ITKNIFTI ITKIONIFTI ITKIONRRD ITKIOMeta ITKIOGIPL ITKIOGDCM)
find_package(ZLIB REQUIRED)
find_package(DCMTK CONFIG REQUIRED)
# Targets that a package imports are known in this folder only; what links to us from elsewhere needs them too.
get_property(image_imported DIRECTORY PROPERTY IMPORTED_TARGETS)
foreach(target IN LISTS image_imported)
  get_target_property(image_global ${target} IMPORTED_GLOBAL)
  if(NOT image_global)
    set_target_properties(${target} PROPERTIES IMPORTED_GLOBAL TRUE)
  endif()
endforeach()
stackmesh_module(image
  SOURCES read_labels.cpp read_image.cpp read_contours.cpp volume_file.cpp volume_header.cpp deflate_check.cpp slices.cpp png_check.cpp
          masks.cpp palette.cpp file_names.cpp dicom_dataset.cpp dicom_grid.cpp
          dicom_segmentation.cpp dicom_series.cpp dicom_pixels.cpp read_structure_set.cpp segments.cpp slicer_segments.cpp text_header.cpp
  HEADERS read_labels.h read_image.h read_contours.h read_structure_set.h dicom_file.h dicom_series.h
  USES base model
  PRIVATE ${ITK_LIBRARIES} opencv_core opencv_imgcodecs ZLIB::ZLIB DCMTK::dcmdata DCMTK::oflog DCMTK::ofstd)
target_include_directories(stackmesh_image SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
