# What `cmake --install` puts where, and what find_package(FastCloth) finds.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(FASTCLOTH_COMPONENTS core files body authoring collision physics graph model bullet)
set(FASTCLOTH_INCLUDE_DIR ${CMAKE_INSTALL_INCLUDEDIR}/fastcloth)
set(FASTCLOTH_ASSETS_DIR ${CMAKE_INSTALL_DATADIR}/fastcloth/assets)
set(FASTCLOTH_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/FastCloth)

set(installed_targets cloth_flags)
foreach(component ${FASTCLOTH_COMPONENTS})
  set_target_properties(cloth_${component} PROPERTIES EXPORT_NAME ${component})
  list(APPEND installed_targets cloth_${component})
endforeach()
set_target_properties(cloth_flags PROPERTIES EXPORT_NAME flags)  # warnings; nothing for users

target_compile_definitions(cloth_core INTERFACE
  $<INSTALL_INTERFACE:CLOTH_INSTALLED_ASSETS="$<INSTALL_PREFIX>/${FASTCLOTH_ASSETS_DIR}">)

install(TARGETS ${installed_targets} EXPORT FastClothTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${FASTCLOTH_INCLUDE_DIR})
install(EXPORT FastClothTargets NAMESPACE FastCloth:: DESTINATION ${FASTCLOTH_CMAKE_DIR})

install(FILES ${PROJECT_SOURCE_DIR}/gnn/stepper.h DESTINATION ${FASTCLOTH_INCLUDE_DIR}/gnn)
foreach(folder data collision gnn/physics gnn/graph gnn/model bullet_ext)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder}/ DESTINATION ${FASTCLOTH_INCLUDE_DIR}/${folder}
          FILES_MATCHING PATTERN "*.h" PATTERN assets EXCLUDE PATTERN cmake EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/data/assets/ DESTINATION ${FASTCLOTH_ASSETS_DIR}
        PATTERN figures EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/fastcloth)

configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/FastClothConfig.cmake.in
  ${PROJECT_BINARY_DIR}/FastClothConfig.cmake INSTALL_DESTINATION ${FASTCLOTH_CMAKE_DIR}
  PATH_VARS FASTCLOTH_ASSETS_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/FastClothConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/FastClothConfig.cmake
              ${PROJECT_BINARY_DIR}/FastClothConfigVersion.cmake
        DESTINATION ${FASTCLOTH_CMAKE_DIR})

# from lib/pkgconfig, or lib/x86_64-linux-gnu/pkgconfig, back to the prefix
file(RELATIVE_PATH FASTCLOTH_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" FASTCLOTH_PC_PREFIX "${FASTCLOTH_PC_PREFIX}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/fastcloth.pc.in ${PROJECT_BINARY_DIR}/fastcloth.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/fastcloth.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
