# The run's figures as a report: JSON with the fields of modules/report/README.md.
stackmesh_module(report
  SOURCES run_report.cpp
  HEADERS run_report.h
  USES base model validate
  PRIVATE nlohmann_json::nlohmann_json)
