# How the library responds to the compiler's options: an older language or compiler gets one sentence, and where there are no vectors it
# does without, and without xsimd, even without TACTNET_NO_SIMD.
#
# cmake -DCOMPILERS=a|b -DARMHF=<compiler for 32-bit ARM, or nothing> -DINCLUDE=<folder that holds tactnet/> \
#       -DX86=<whether COMPILERS are for x86-64> -DFOLDER=<to write in> -P configuration.cmake
cmake_minimum_required(VERSION 3.22)

string(REPLACE "|" ";" COMPILERS "${COMPILERS}")
set(ENV{LC_ALL} C)

foreach(header IN ITEMS tactnet training sensors version)
    set(source "${FOLDER}/older_language_${header}.cpp")
    file(WRITE "${source}" "#include <tactnet/${header}.hpp>\nint main() {}\n")
    foreach(compiler IN LISTS COMPILERS)
        # The last ones: a compiler that is too old, though it knows the language.
        foreach(
            standard IN
            ITEMS c++11 c++17
                  "c++20 -U__GNUC__ -D__GNUC__=11 -U__clang_major__ -D__clang_major__=13"
        )
            separate_arguments(options UNIX_COMMAND "-std=${standard}")
            execute_process(
                COMMAND "${compiler}" ${options} "-I${INCLUDE}" -fsyntax-only "${source}"
                RESULT_VARIABLE status
                OUTPUT_VARIABLE output
                ERROR_VARIABLE output
            )
            if(header STREQUAL "version")
                if(NOT status EQUAL 0)
                    message(FATAL_ERROR "version.hpp must be read in any language, found with ${standard}\n${output}")
                endif()
                continue()
            endif()
            if(status EQUAL 0 OR NOT output MATCHES "tactnet needs C\\+\\+20: GCC 12, Clang 14 or newer with -std=c\\+\\+20")
                message(FATAL_ERROR "${header}.hpp with ${standard}: expected a sentence on C++20, found\n${output}")
            endif()
            # The sentence, and that the compiler stops there.
            string(REGEX MATCHALL "error: " errors "${output}")
            list(LENGTH errors count)
            if(count GREATER 2)
                message(FATAL_ERROR "${header}.hpp with ${standard}: the sentence is lost among others:\n${output}")
            endif()
        endforeach()
    endforeach()
endforeach()
message("${output}")

set(source "${FOLDER}/without_vectors.cpp")
file(
    WRITE "${source}"
    "#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/networks.hpp>
#if !defined(TACTNET_NO_SIMD) || defined(XSIMD_VERSION_MAJOR)
#error \"vectors, where there are none\"
#endif
static_assert(tactnet::kernels::lanes<float> == 1 && tactnet::kernels::lanes<double> == 1);
static_assert(tactnet::tactnet4<tactnet::shape{7, 13}, 22>::parameters > 0);
"
)
function(expect_without_vectors compiler)
    execute_process(
        COMMAND "${compiler}" -std=c++20 ${ARGN} "-I${INCLUDE}" -fsyntax-only "${source}"
        RESULT_VARIABLE status
        OUTPUT_VARIABLE output
        ERROR_VARIABLE output
    )
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "${compiler} ${ARGN}: expected to do without vectors, found\n${output}")
    endif()
    message("without vectors: ${compiler} ${ARGN}")
endfunction()
if(X86)
    foreach(compiler IN LISTS COMPILERS)
        expect_without_vectors("${compiler}" -U__SSE2__) # as with -mno-sse, which no 64-bit system's headers bear
    endforeach()
endif()
if(ARMHF)
    expect_without_vectors("${ARMHF}")
    expect_without_vectors("${ARMHF}" -mfpu=neon) # vectors of float, but not of double
else()
    message("without vectors: not tried for 32-bit ARM, for want of a compiler")
endif()
