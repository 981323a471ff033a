# What `cmake --install` puts where, and what find_package(FastCloth) and pkg-config find.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(FASTCLOTH_INCLUDE_DIR ${CMAKE_INSTALL_INCLUDEDIR}/fastcloth)
set(FASTCLOTH_ASSETS_DIR ${CMAKE_INSTALL_DATADIR}/fastcloth/assets)
set(FASTCLOTH_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/FastCloth)
# from lib/pkgconfig, or lib/x86_64-linux-gnu/pkgconfig, back to the prefix
file(RELATIVE_PATH FASTCLOTH_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" FASTCLOTH_PC_PREFIX "${FASTCLOTH_PC_PREFIX}")

# Every component is a library cloth_NAME; those that it needs come before it.
set(FASTCLOTH_COMPONENTS core files body collision physics graph model bullet)
set(FASTCLOTH_HEADERS data/core data/files data/body collision gnn/physics gnn/graph gnn/model
                      bullet_ext)
if(CLOTH_WITH_AUTHORING)
  list(APPEND FASTCLOTH_COMPONENTS authoring)
  list(APPEND FASTCLOTH_HEADERS data/authoring)
endif()

# Libraries of others, as targets link them: what find_package() calls them, and how pkg-config's
# users link them. PkgConfig::NAME needs no entry.
set(package_of_Eigen3::Eigen Eigen3)
set(pc_requires_of_Eigen3::Eigen "eigen3 >= 3.4")
set(package_of_OpenMP::OpenMP_CXX OpenMP)
list(TRANSFORM OpenMP_CXX_LIB_NAMES PREPEND "-l" OUTPUT_VARIABLE pc_libs_of_OpenMP::OpenMP_CXX)
set(package_of_fcl fcl)
set(pc_libs_of_fcl -lfcl)
set(package_of_assimp::assimp assimp)
set(pc_libs_of_assimp::assimp -lassimp)
set(package_of_CGAL::CGAL CGAL)
set(pc_libs_of_CGAL::CGAL -lmpfr -lgmp)
# Warnings, and headers that no installed header includes.
set(build_only cloth_flags nlohmann_json::nlohmann_json)

# cloth_component(NAME): installs a library; what it links becomes what its users have to find.
function(cloth_component component)
  set(target cloth_${component})
  get_target_property(links ${target} INTERFACE_LINK_LIBRARIES)
  set(needs)
  set(packages)
  set(pc_requires)
  set(pc_libs)
  set(kept)
  foreach(link IN LISTS links)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" name "${link}")
    if(name IN_LIST build_only)
      continue()
    elseif(name MATCHES "^cloth(::|_)([a-z]+)$")
      list(APPEND needs ${CMAKE_MATCH_2})
      list(APPEND pc_requires fastcloth-${CMAKE_MATCH_2})
    elseif(name MATCHES "^PkgConfig::(.*)$")
      string(TOLOWER ${CMAKE_MATCH_1} module)
      list(APPEND packages pkg-config:${module})
      list(APPEND pc_requires ${module})
    elseif(DEFINED package_of_${name})
      list(APPEND packages ${package_of_${name}})
      list(APPEND pc_requires ${pc_requires_of_${name}})
      list(APPEND pc_libs ${pc_libs_of_${name}})
    else()
      message(FATAL_ERROR "${target} links ${name}: say above how its users find that")
    endif()
    list(APPEND kept ${link})
  endforeach()
  # Shared libraries of users link these, too. The compiler need not expect that they replace our functions:
  # it inlines as it does for a program.
  if(NOT DEFINED CMAKE_POSITION_INDEPENDENT_CODE)
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  endif()
  target_compile_options(${target} PRIVATE -fno-semantic-interposition)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component}
                                             INTERFACE_LINK_LIBRARIES "${kept}")
  install(TARGETS ${target} EXPORT FastCloth-${component}
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          INCLUDES DESTINATION ${FASTCLOTH_INCLUDE_DIR})
  install(EXPORT FastCloth-${component} NAMESPACE FastCloth:: DESTINATION ${FASTCLOTH_CMAKE_DIR})
  set(FASTCLOTH_NEEDS "${FASTCLOTH_NEEDS}set(FastCloth_${component}_needs ${needs})
set(FastCloth_${component}_packages ${packages})\n" PARENT_SCOPE)

  get_target_property(definitions ${target} INTERFACE_COMPILE_DEFINITIONS)
  list(FILTER definitions INCLUDE REGEX "^[A-Za-z_]+=[A-Za-z0-9]+$")
  list(TRANSFORM definitions PREPEND "-D")
  list(JOIN definitions " " PC_DEFINITIONS)
  list(REMOVE_DUPLICATES pc_requires)
  list(JOIN pc_requires ", " PC_REQUIRES)
  list(JOIN pc_libs " " PC_LIBS)
  set(pc ${PROJECT_BINARY_DIR}/fastcloth-${component}.pc)
  configure_file(${PROJECT_SOURCE_DIR}/bullet_ext/cmake/component.pc.in ${pc} @ONLY)
  install(FILES ${pc} DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

target_compile_definitions(cloth_core INTERFACE
  $<INSTALL_INTERFACE:CLOTH_INSTALLED_ASSETS="$<INSTALL_PREFIX>/${FASTCLOTH_ASSETS_DIR}">)
foreach(component ${FASTCLOTH_COMPONENTS})
  cloth_component(${component})
endforeach()
configure_file(${CMAKE_CURRENT_LIST_DIR}/fastcloth.pc.in ${PROJECT_BINARY_DIR}/fastcloth.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/fastcloth.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

install(FILES ${PROJECT_SOURCE_DIR}/gnn/deadline.h ${PROJECT_SOURCE_DIR}/gnn/stepper.h DESTINATION ${FASTCLOTH_INCLUDE_DIR}/gnn)
foreach(folder ${FASTCLOTH_HEADERS})
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION ${FASTCLOTH_INCLUDE_DIR}/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN cmake EXCLUDE
          PATTERN json_integers.h EXCLUDE)  # for .cpp files: shows a type of nlohmann's
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/assets/ DESTINATION ${FASTCLOTH_ASSETS_DIR}
        PATTERN figures EXCLUDE PATTERN training EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/bullet_ext/LICENCES.md
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fastcloth)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/FastClothConfig.cmake.in
  ${PROJECT_BINARY_DIR}/FastClothConfig.cmake INSTALL_DESTINATION ${FASTCLOTH_CMAKE_DIR}
  PATH_VARS FASTCLOTH_ASSETS_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/FastClothConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/FastClothConfig.cmake
              ${PROJECT_BINARY_DIR}/FastClothConfigVersion.cmake
        DESTINATION ${FASTCLOTH_CMAKE_DIR})
