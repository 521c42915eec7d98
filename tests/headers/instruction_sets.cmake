# Units for different instruction sets must not share a name: each option that changes the code changes the inline
# namespace.
#
# cmake -DCOMPILER=... -DINCLUDE=<folder that holds tactnet/> -DFOLDER=<to write in> -P instruction_sets.cmake
cmake_minimum_required(VERSION 3.22)

file(WRITE "${FOLDER}/name_of_namespace.cpp" "#include <tactnet/detail/config.hpp>\nname: TACTNET_ARCH\n")
set(names "")
foreach(options IN ITEMS
        "-march=x86-64"
        "-msse3"
        "-mssse3"
        "-msse4.1"
        "-msse4.2"
        "-mavx"
        "-mavx -mfma"
        "-mavx -mfma4"
        "-mavx2"
        "-mavx2 -mfma"
        "-mavx2 -mfma -mbmi2"
        "-mavx2 -mfma -mbmi2 -mlzcnt"
        "-mfma -mavx512f"
        "-mfma -mavx512f -mavx512cd"
        "-mfma -mavx512f -mavx512cd -mavx512dq"
        "-mfma -mavx512f -mavx512cd -mavx512dq -mavx512bw"
        "-mfma -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl"
        "-mfma -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx512vnni"
        "-mfma -mavx512f -mavx512cd -mavx512dq -mavx512bw -mavx512vl -mavx512vbmi"
        "-DTACTNET_NO_SIMD"
        "-DTACTNET_NO_SIMD -mavx2"
)
    string(REPLACE " " ";" arguments "${options}")
    execute_process(
        COMMAND "${COMPILER}" -std=c++20 ${arguments} "-I${INCLUDE}" -E -P "${FOLDER}/name_of_namespace.cpp"
        OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY
    )
    if(NOT output MATCHES "name: ([a-zA-Z0-9_]+)\n")
        message(FATAL_ERROR "With '${options}' the namespace's name is no identifier:\n${output}")
    endif()
    set(name "${CMAKE_MATCH_1}")
    if(name IN_LIST names)
        message(FATAL_ERROR "'${options}' gives the name ${name}, which others have: ${names}")
    endif()
    list(APPEND names ${name})
endforeach()
message("${names}")
