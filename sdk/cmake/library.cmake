# How the libraries of the SDK are built and installed: static by default, shared with BUILD_SHARED_LIBS.
#
# mesocell_library(NAME COMPONENT HEADERS...) makes the library NAME, whose sources were given to add_library(), a
# part of the installed COMPONENT (loader, runtime or authoring). HEADERS are the public ones, relative to the
# project's root; they are installed in their folders below include/mesocell, and only they are.
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(MESOCELL_CMAKEDIR ${CMAKE_INSTALL_LIBDIR}/cmake/mesocell)
set(MESOCELL_EXPORT_MAP ${CMAKE_CURRENT_LIST_DIR}/exports.map)
set(MESOCELL_TEMPLATES ${CMAKE_CURRENT_LIST_DIR})

function(mesocell_library name component)
  string(REPLACE mesocell_ "" export_name ${name})
  set(headers ${ARGN})
  list(TRANSFORM headers PREPEND ${PROJECT_SOURCE_DIR}/)
  target_sources(${name} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR} FILES ${headers})
  # The flags are for building alone: an installed library does not ask its users for them.
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:mesocell_flags>)
  set_target_properties(${name} PROPERTIES
    EXPORT_NAME ${export_name}
    VERSION ${PROJECT_VERSION}
    # Before 1.0 a minor version may change the binary interface.
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    # Static and shared libraries have the same objects.
    DEFINE_SYMBOL ""
    VISIBILITY_INLINES_HIDDEN ON
    INSTALL_RPATH "$ORIGIN")
  if(NOT component STREQUAL "loader")
    target_compile_features(${name} PUBLIC cxx_std_20)
    # Installed headers export what they declare (format/api.h); the loader's functions are all public.
    set_target_properties(${name} PROPERTIES CXX_VISIBILITY_PRESET hidden)
  endif()
  get_target_property(type ${name} TYPE)
  if(type STREQUAL "SHARED_LIBRARY" AND UNIX AND NOT APPLE)
    target_link_options(${name} PRIVATE LINKER:--version-script=${MESOCELL_EXPORT_MAP})
    set_target_properties(${name} PROPERTIES LINK_DEPENDS ${MESOCELL_EXPORT_MAP})
  endif()
  install(TARGETS ${name} EXPORT mesocell-${component}
    ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${component}
    FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mesocell COMPONENT ${component})
  set_property(GLOBAL APPEND PROPERTY MESOCELL_COMPONENTS ${component})
endfunction()

# Installs a pkg-config file. DEPENDS and SYSTEM_LIBS are of the library's own: users of a static one link them too.
function(mesocell_pkg_config name component description)
  cmake_parse_arguments(PARSE_ARGV 3 arg "" "REQUIRES;DEPENDS;LIBS;SYSTEM_LIBS" "")
  if(BUILD_SHARED_LIBS)
    set(requires "Requires: ${arg_REQUIRES}\nRequires.private: ${arg_DEPENDS}")
    set(libs "Libs: -L\${libdir} ${arg_LIBS}\nLibs.private: ${arg_SYSTEM_LIBS}")
  else()
    set(requires "Requires: ${arg_REQUIRES} ${arg_DEPENDS}")
    set(libs "Libs: -L\${libdir} ${arg_LIBS} ${arg_SYSTEM_LIBS}")
  endif()
  if(IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}" OR IS_ABSOLUTE "${CMAKE_INSTALL_INCLUDEDIR}")
    set(prefix "${CMAKE_INSTALL_PREFIX}")
    set(libdir "${CMAKE_INSTALL_FULL_LIBDIR}")
    set(includedir "${CMAKE_INSTALL_FULL_INCLUDEDIR}")
  else()
    # Relative to the file, so that an installation can be moved.
    file(RELATIVE_PATH up /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
    string(REGEX REPLACE "/$" "" up "${up}")
    set(prefix "\${pcfiledir}/${up}")
    set(libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
    set(includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
  endif()
  configure_file(${MESOCELL_TEMPLATES}/mesocell.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT ${component})
endfunction()

# Installs the CMake package, the pkg-config files and the licence; after all libraries.
function(mesocell_install_package)
  get_property(components GLOBAL PROPERTY MESOCELL_COMPONENTS)
  list(REMOVE_DUPLICATES components)
  foreach(component IN LISTS components)
    install(EXPORT mesocell-${component} NAMESPACE mesocell::
      FILE mesocell-${component}-targets.cmake DESTINATION ${MESOCELL_CMAKEDIR} COMPONENT ${component})
  endforeach()
  configure_package_config_file(${MESOCELL_TEMPLATES}/mesocell-config.cmake.in
    ${PROJECT_BINARY_DIR}/mesocell-config.cmake
    INSTALL_DESTINATION ${MESOCELL_CMAKEDIR} NO_SET_AND_CHECK_MACRO NO_CHECK_REQUIRED_COMPONENTS_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/mesocell-config-version.cmake
    COMPATIBILITY SameMinorVersion)
  # The smallest component carries what all of them need.
  install(FILES
    ${PROJECT_BINARY_DIR}/mesocell-config.cmake ${PROJECT_BINARY_DIR}/mesocell-config-version.cmake
    DESTINATION ${MESOCELL_CMAKEDIR} COMPONENT loader)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT loader)

  mesocell_pkg_config(mesocell-loader loader "Compact loader of .meso files"
    DEPENDS libzstd LIBS "-lmesocell_loader")
  set(highway)
  if(MESOCELL_HIGHWAY)
    set(highway libhwy)
  endif()
  mesocell_pkg_config(mesocell runtime "Reads, writes, traces and shades .meso files"
    DEPENDS "libzstd ${highway}" SYSTEM_LIBS "-pthread"
    LIBS "-lmesocell_measure -lmesocell_shade -lmesocell_trace -lmesocell_core -lmesocell_format")
  if("authoring" IN_LIST components)
    mesocell_pkg_config(mesocell-authoring authoring "Makes .meso files of meshes and tiles"
      REQUIRES "mesocell = ${PROJECT_VERSION}" SYSTEM_LIBS "-lmpfr -lgmp"
      LIBS "-lmesocell_author -lmesocell_surface -lmesocell_membership -lmesocell_tiles")
  endif()
endfunction()
