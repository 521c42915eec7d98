# What a deployed network takes of a microcontroller: TactNet-4 for 14 × 25 tactels in single precision and in 8 bits, on
# Cortex-M7 and Cortex-M4. Fails if 8 bits take more than 24 kB of flash or 16 kB of RAM with the stack, if a program
# holds a heap or exceptions, if a self-test fails, or if the table on the page is another one.
#
# cmake -DCOMPILER=arm-none-eabi-g++ -DEMULATOR=qemu-system-arm -DINCLUDE=<this library> -DHEADERS=<of write_headers>
#       -DFOLDER=<to build in> -DPAGE=docs/deployment.md [-DWRITE=ON] -P check.cmake
#
# With WRITE the table takes the place of the one on the page. Without an emulator only flash and static RAM are checked.
cmake_minimum_required(VERSION 3.22)
if(NOT COMPILER)
    message("skipped: there is no arm-none-eabi-g++ (Debian: gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib)")
    return()
endif()
set(SOURCE "${CMAKE_CURRENT_LIST_DIR}/firmware.cpp")
set(SCRIPT "${CMAKE_CURRENT_LIST_DIR}/firmware.ld")
string(REGEX REPLACE "g\\+\\+([^/]*)$" "size\\1" SIZE "${COMPILER}")
string(REGEX REPLACE "g\\+\\+([^/]*)$" "nm\\1" NM "${COMPILER}")
file(MAKE_DIRECTORY "${FOLDER}")
include("${CMAKE_CURRENT_LIST_DIR}/one_firmware.cmake")
include("${CMAKE_CURRENT_LIST_DIR}/page_table.cmake")

# 20 240 bytes as 20.2
function(kilobytes bytes result)
    math(EXPR tenths "(${bytes} + 50) / 100")
    math(EXPR whole "${tenths} / 10")
    math(EXPR rest "${tenths} % 10")
    set(${result} "${whole}.${rest}" PARENT_SCOPE)
endfunction()

set(table "| TactNet-4, 14 × 25 | single precision | 8 bits |\n|---|---|---|\n")
foreach(processor IN ITEMS cortex-m7 cortex-m4)
    string(REGEX REPLACE "cortex-m" "Cortex-M" name ${processor})
    foreach(level IN ITEMS -Os -O2)
        foreach(form IN ITEMS single_precision eight_bit)
            build_firmware(of PROCESSOR ${processor} LEVEL ${level} FORM ${form})
            math(EXPR ram "${of_static} + ${of_stack}")
            math(EXPR ${form}_thousands "(${of_instructions} + 500) / 1000")
            kilobytes(${of_flash} ${form}_flash)
            kilobytes(${ram} ${form}_ram)
            message("${name} ${level} ${form}: flash ${of_flash} bytes, static RAM ${of_static}, stack ${of_stack}, "
                    "instructions of a frame ${of_instructions}")
        endforeach()
        # The last was in 8 bits.
        if(level STREQUAL "-Os" AND (of_flash GREATER 24000 OR ram GREATER 16000))
            message(FATAL_ERROR "microcontroller: expected at most 24000 bytes of flash and 16000 of RAM in 8 bits on "
                                "${name}, found ${of_flash} and ${ram}.")
        endif()
        string(APPEND table
               "| ${name}, `${level}`: flash, kB | ${single_precision_flash} | ${eight_bit_flash} |\n"
               "| the same: RAM with the stack, kB | ${single_precision_ram} | ${eight_bit_ram} |\n"
               "| the same: thousands of instructions a frame | ${single_precision_thousands} | ${eight_bit_thousands} |\n"
        )
    endforeach()
endforeach()
message("${table}")
if(EMULATOR)
    compare_with_page("${table}")
endif()
