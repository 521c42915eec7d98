# The target `reference`: every public name on pages that open from reference/html/index.html in the build folder.

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
