# The target `reference`: every public name on pages that open from reference/html/index.html in the build folder; and the
# target `site`: these and the pages of docs/, with a search, in the folder `site`, for any static host.

# tactnet_add_reference(): does nothing but say so where Doxygen is missing.
function(tactnet_add_reference)
    find_package(Doxygen QUIET)
    if(NOT DOXYGEN_FOUND)
        message(STATUS "tactnet: the target reference is left out (needs doxygen)")
        return()
    endif()
    # The theme of Debian's package doxygen-awesome-css; without it, Doxygen's own.
    find_file(TACTNET_DOXYGEN_THEME doxygen-awesome.css PATH_SUFFIXES share/doxygen-awesome-css)
    set(reference_stylesheets "\"${PROJECT_SOURCE_DIR}/docs/reference/reference.css\"")
    if(TACTNET_DOXYGEN_THEME)
        string(PREPEND reference_stylesheets "\"${TACTNET_DOXYGEN_THEME}\" ")
    endif()
    set(reference_folder "${PROJECT_BINARY_DIR}/reference")
    configure_file("${PROJECT_SOURCE_DIR}/docs/reference/Doxyfile.in" "${reference_folder}/Doxyfile" @ONLY)
    add_custom_target(
        reference
        COMMAND
            "${CMAKE_COMMAND}" "-DDOXYGEN=${DOXYGEN_EXECUTABLE}" "-DFOLDER=${reference_folder}" -P
            "${PROJECT_SOURCE_DIR}/docs/reference/make.cmake"
        COMMENT "The reference: ${reference_folder}/html/index.html"
        VERBATIM
    )
endfunction()

# tactnet_add_site(): after tactnet_add_reference(); does nothing but say so where something is missing.
function(tactnet_add_site)
    find_package(Python3 3.7 QUIET COMPONENTS Interpreter)
    find_program(TACTNET_MKDOCS mkdocs)
    # Its theme follows the reader's choice of light or dark, as the pictures do.
    find_file(TACTNET_MKDOCS_THEME material/main.html PATH_SUFFIXES share/mkdocs/themes)
    if(NOT TARGET reference OR NOT Python3_FOUND OR NOT TACTNET_MKDOCS OR NOT TACTNET_MKDOCS_THEME)
        message(STATUS "tactnet: the target site is left out (needs doxygen, python3, mkdocs and mkdocs-material)")
        return()
    endif()
    add_custom_target(
        site
        COMMAND
            "${Python3_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/docs/site/make.py" --mkdocs "${TACTNET_MKDOCS}" --reference
            "${PROJECT_BINARY_DIR}/reference/html" --out "${PROJECT_BINARY_DIR}/site" --version "${PROJECT_VERSION}"
        COMMENT "The site: ${PROJECT_BINARY_DIR}/site/index.html"
        VERBATIM
    )
    add_dependencies(site reference)
endfunction()
