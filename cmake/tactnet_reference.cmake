# The target `reference`: every public name on pages that open from reference/html/index.html in the build folder.

# tactnet_add_reference(): does nothing but say so where Doxygen or Python 3 is missing.
function(tactnet_add_reference)
    find_package(Doxygen QUIET)
    find_package(Python3 QUIET COMPONENTS Interpreter)
    if(NOT DOXYGEN_FOUND OR NOT Python3_Interpreter_FOUND)
        message(STATUS "tactnet: the target reference is left out (needs doxygen and python3)")
        return()
    endif()
    # The interpreter itself, not what picks one: the filter starts for each header.
    execute_process(
        COMMAND "${Python3_EXECUTABLE}" -c "import sys; print(sys.executable, end='')" OUTPUT_VARIABLE reference_python
    )
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
            "${CMAKE_COMMAND}" "-DDOXYGEN=${DOXYGEN_EXECUTABLE}" "-DFOLDER=${reference_folder}"
            "-DKNOWN=${PROJECT_SOURCE_DIR}/docs/reference/without_sentence.txt" -P
            "${PROJECT_SOURCE_DIR}/docs/reference/make.cmake"
        COMMENT "The reference: ${reference_folder}/html/index.html"
        VERBATIM
    )
endfunction()
