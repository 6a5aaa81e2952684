# The version is the header's. Before 1.0 the versions of one minor version fit each other.
file(STRINGS "${CMAKE_CURRENT_LIST_DIR}/../../../include/srbf.h" srbf_line REGEX "^#define SRBF_VERSION [0-9]+$")
string(REGEX REPLACE "^#define SRBF_VERSION " "" srbf_number "${srbf_line}")
math(EXPR srbf_major "${srbf_number} / 10000")
math(EXPR srbf_minor "${srbf_number} / 100 % 100")
math(EXPR srbf_patch "${srbf_number} % 100")
set(PACKAGE_VERSION "${srbf_major}.${srbf_minor}.${srbf_patch}")
if(PACKAGE_FIND_VERSION VERSION_LESS_EQUAL PACKAGE_VERSION AND PACKAGE_FIND_VERSION_MAJOR EQUAL srbf_major
        AND (srbf_major GREATER 0 OR PACKAGE_FIND_VERSION_MINOR EQUAL srbf_minor))
    set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
if(PACKAGE_FIND_VERSION VERSION_EQUAL PACKAGE_VERSION)
    set(PACKAGE_VERSION_EXACT TRUE)
endif()
