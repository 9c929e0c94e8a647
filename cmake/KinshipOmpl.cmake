# OMPL's package defines no target, and names libraries that only its extensions need. Who finds the installed planning
# component reads this file too.
if(NOT TARGET kinship_ompl_package)
  find_library(KINSHIP_OMPL_LIBRARY ompl PATHS ${OMPL_LIBRARY_DIR} REQUIRED)
  # The headers of OMPL's databases of experience use it.
  find_library(KINSHIP_BOOST_SERIALIZATION_LIBRARY boost_serialization REQUIRED)
  mark_as_advanced(KINSHIP_OMPL_LIBRARY KINSHIP_BOOST_SERIALIZATION_LIBRARY)
  add_library(kinship_ompl_package INTERFACE IMPORTED GLOBAL)
  target_include_directories(kinship_ompl_package SYSTEM INTERFACE ${OMPL_INCLUDE_DIR})
  target_link_libraries(kinship_ompl_package INTERFACE ${KINSHIP_OMPL_LIBRARY}
                        ${KINSHIP_BOOST_SERIALIZATION_LIBRARY} Eigen3::Eigen)
endif()
