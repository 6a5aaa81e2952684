# find_package(srbf), then target_link_libraries(app srbf::srbf): the shared library if BUILD_SHARED_LIBS is on, else the
# static one; or say which by srbf::static and srbf::shared. Of an installation by CMake or by cargo-c, wherever it has been moved.

# PREFIX/share/cmake/srbf
get_filename_component(srbf_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
foreach(srbf_name static shared)
    if(srbf_name STREQUAL "static")
        set(srbf_file libsrbf.a)
    else()
        set(srbf_file libsrbf.so)
    endif()
    # Anew each time: a cached place may be that of an installation which is not this one.
    unset(srbf_${srbf_name} CACHE)
    find_library(srbf_${srbf_name} ${srbf_file} NO_DEFAULT_PATH
        PATHS "${srbf_prefix}" PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE} lib lib64)
    if(srbf_${srbf_name} AND NOT TARGET srbf::${srbf_name})
        string(TOUPPER ${srbf_name} srbf_kind)
        add_library(srbf::${srbf_name} ${srbf_kind} IMPORTED)
        set_target_properties(srbf::${srbf_name} PROPERTIES
            IMPORTED_LOCATION "${srbf_${srbf_name}}"
            INTERFACE_INCLUDE_DIRECTORIES "${srbf_prefix}/include")
    endif()
    unset(srbf_${srbf_name} CACHE)
endforeach()
if(TARGET srbf::static)
    # What `rustc --print native-static-libs` says that a static library of Rust needs on Linux with glibc; see CMakeLists.txt for -lgcc_s.
    set_target_properties(srbf::static PROPERTIES
        INTERFACE_LINK_LIBRARIES "-lutil;-lrt;-lpthread;-lm;-ldl")
endif()
if(NOT TARGET srbf::srbf)
    add_library(srbf::srbf INTERFACE IMPORTED)
    if(TARGET srbf::shared AND (BUILD_SHARED_LIBS OR NOT TARGET srbf::static))
        target_link_libraries(srbf::srbf INTERFACE srbf::shared)
    elseif(TARGET srbf::static)
        target_link_libraries(srbf::srbf INTERFACE srbf::static)
    else()
        set(srbf_FOUND FALSE)
        set(srbf_NOT_FOUND_MESSAGE "neither libsrbf.a nor libsrbf.so is in a folder for libraries of ${srbf_prefix}")
    endif()
endif()
