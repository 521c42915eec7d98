# What a deployed network takes of a microcontroller: TactNet-4 for 14 × 25 tactels in single precision and in 8 bits, on
# Cortex-M7 and Cortex-M4. Fails if 8 bits take more than 24 kB of flash or 16 kB of RAM with the stack, if a program
# holds a heap or exceptions, if a self-test fails, or if the table on the page is another one.
#
# cmake -DCOMPILER=arm-none-eabi-g++ -DEMULATOR=qemu-system-arm -DINCLUDE=<this library> -DHEADERS=<of write_headers>
#       -DFOLDER=<to build in> -DPAGE=docs/recognise/eight_bit.md [-DWRITE=ON] -P check.cmake
#
# With WRITE the table takes the place of the one on the page. Without an emulator only flash and static RAM are checked.
cmake_minimum_required(VERSION 3.22)
if(NOT COMPILER)
    message("skipped: there is no arm-none-eabi-g++ (Debian: gcc-arm-none-eabi, libstdc++-arm-none-eabi-newlib)")
    return()
endif()
set(SCRIPT "${CMAKE_CURRENT_LIST_DIR}/firmware.ld")
string(REGEX REPLACE "g\\+\\+([^/]*)$" "size\\1" SIZE "${COMPILER}")
string(REGEX REPLACE "g\\+\\+([^/]*)$" "nm\\1" NM "${COMPILER}")
file(MAKE_DIRECTORY "${FOLDER}")

# Bytes of a program's sections, as `size` prints them: text, data, bss.
function(sections_of program result)
    execute_process(COMMAND "${SIZE}" "${program}" OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    if(NOT output MATCHES "\n *([0-9]+)[ \t]+([0-9]+)[ \t]+([0-9]+)")
        message(FATAL_ERROR "microcontroller: expected sizes from ${SIZE}, found:\n${output}")
    endif()
    set(${result} ${CMAKE_MATCH_1} ${CMAKE_MATCH_2} ${CMAKE_MATCH_3} PARENT_SCOPE)
endfunction()

# build_firmware(prefix SOURCE firmware PROCESSOR cortex-m7 LEVEL -Os FORM eight_bit [RAM 32768]): sets <prefix>_flash, <prefix>_static and
# <prefix>_stack in bytes, and <prefix>_instructions of a frame. The last two are 0 without an emulator.
function(build_firmware prefix)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "SOURCE;PROCESSOR;LEVEL;FORM;RAM" "")
    set(unit_cortex-m7 fpv5-sp-d16)
    set(unit_cortex-m4 fpv4-sp-d16)
    set(board_cortex-m7 mps2-an500)
    set(board_cortex-m4 mps2-an386)
    set(options
        -std=c++20 ${arg_LEVEL} -mthumb -mcpu=${arg_PROCESSOR} -mfpu=${unit_${arg_PROCESSOR}} -mfloat-abi=hard
        -fno-exceptions -fno-rtti -ffunction-sections -fdata-sections -Wall -Wextra -Wpedantic -Wconversion -Wshadow
        -Werror "-DTEST_HEADER=\"${arg_FORM}.hpp\"" -DNDEBUG ${OPTIONS} "-I${HEADERS}" "-I${INCLUDE}"
        -nostartfiles -Wl,--gc-sections "-T${SCRIPT}" "${CMAKE_CURRENT_LIST_DIR}/${arg_SOURCE}.cpp"
    )
    if(arg_RAM)
        list(APPEND options "-Wl,--defsym=ram_bytes=${arg_RAM}")
    endif()
    if(arg_FORM STREQUAL "eight_bit")
        list(APPEND options -DTEST_SAME_BITS)
    endif()
    set(program "${FOLDER}/${arg_FORM}_${arg_PROCESSOR}${arg_LEVEL}")
    # Without what counts, which no product has.
    execute_process(COMMAND "${COMPILER}" ${options} -o "${program}.elf" COMMAND_ERROR_IS_FATAL ANY)
    sections_of("${program}.elf" sections)
    list(GET sections 0 text)
    list(GET sections 1 data)
    list(GET sections 2 bss)
    math(EXPR flash "${text} + ${data}")
    math(EXPR static "${data} + ${bss}")
    set(${prefix}_flash ${flash} PARENT_SCOPE)
    set(${prefix}_static ${static} PARENT_SCOPE)

    execute_process(COMMAND "${NM}" "${program}.elf" OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY)
    foreach(name IN ITEMS "_?malloc(_r)?" "_?free(_r)?" "_?sbrk(_r)?" "_Znw[a-zA-Z0-9_]*" "_Zna[a-zA-Z0-9_]*" "_Zdl[a-zA-Z0-9_]*" "__cxa_throw" "abort")
        if(names MATCHES " (${name})\n")
            message(FATAL_ERROR "microcontroller: ${program}.elf holds '${CMAKE_MATCH_1}': no heap, no exceptions.")
        endif()
    endforeach()

    set(${prefix}_stack 0 PARENT_SCOPE)
    set(${prefix}_instructions 0 PARENT_SCOPE)
    if(NOT EMULATOR)
        return()
    endif()
    execute_process(COMMAND "${COMPILER}" ${options} -DTEST_REPORT -o "${program}_report.elf" COMMAND_ERROR_IS_FATAL ANY)
    # One nanosecond of the emulated clock an instruction; the timer ticks once in 40 of them.
    execute_process(
        COMMAND
            "${EMULATOR}" -M ${board_${arg_PROCESSOR}} -nographic -monitor none -serial none -icount shift=0
            -semihosting-config enable=on,target=native -kernel "${program}_report.elf"
        RESULT_VARIABLE status
        OUTPUT_VARIABLE output
        ERROR_VARIABLE output
        TIMEOUT 60
    )
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "microcontroller: ${program}_report.elf ended with ${status} (2: the self-test failed, 3: other bits):\n${output}")
    endif()
    if(NOT output MATCHES "stack ([0-9]+)\n")
        message(FATAL_ERROR "microcontroller: expected the bytes of the stack, found:\n${output}")
    endif()
    set(${prefix}_stack ${CMAKE_MATCH_1} PARENT_SCOPE)
    if(NOT output MATCHES "ticks of 20 frames ([0-9]+)\n")
        message(FATAL_ERROR "microcontroller: expected the ticks of 20 frames, found:\n${output}")
    endif()
    math(EXPR instructions "${CMAKE_MATCH_1} * 40 / 20")
    set(${prefix}_instructions ${instructions} PARENT_SCOPE)
endfunction()

# compare_with_page(table): what stands on the page between the comments `<!-- microcontroller -->` and
# `<!-- microcontroller ends -->` must be this table, each number within 5 %: compilers differ, and a table is not written
# anew for every change. With WRITE the table takes its place.
function(compare_with_page table)
    set(begin "<!-- microcontroller -->\n")
    set(end "<!-- microcontroller ends -->")
    file(READ "${PAGE}" text)
    string(FIND "${text}" "${begin}" first)
    string(FIND "${text}" "${end}" last)
    if(first LESS 0 OR last LESS first)
        message(FATAL_ERROR "microcontroller: ${PAGE}: expected '${begin}' and '${end}' behind it.")
    endif()
    string(LENGTH "${begin}" length)
    math(EXPR first "${first} + ${length}")
    math(EXPR length "${last} - ${first}")
    string(SUBSTRING "${text}" ${first} ${length} old)
    if(WRITE)
        string(REPLACE "${begin}${old}" "${begin}${table}" text "${text}")
        file(WRITE "${PAGE}" "${text}")
        return()
    endif()
    foreach(one IN ITEMS old table)
        string(REGEX REPLACE "\\| [0-9.]+ \\| [0-9.]+ \\|" "| |" ${one}_words "${${one}}")
    endforeach()
    if(NOT old_words STREQUAL table_words)
        message(FATAL_ERROR "microcontroller: ${PAGE} has another table; the target microcontroller_table writes it.")
    endif()
    string(REGEX MATCHALL "\\| [0-9.]+ \\| [0-9.]+ \\|" old_rows "${old}")
    string(REGEX MATCHALL "\\| [0-9.]+ \\| [0-9.]+ \\|" table_rows "${table}")
    foreach(old_row table_row IN ZIP_LISTS old_rows table_rows)
        string(REGEX MATCHALL "[0-9.]+" old_numbers "${old_row}")
        string(REGEX MATCHALL "[0-9.]+" table_numbers "${table_row}")
        foreach(was is IN ZIP_LISTS old_numbers table_numbers)
            # In tenths, or all alike in whole numbers.
            string(REPLACE "." "" was_whole "${was}")
            string(REPLACE "." "" is_whole "${is}")
            math(EXPR beyond "20 * (${was_whole} - ${is_whole})")
            math(EXPR before "-${was_whole} - 20")
            math(EXPR behind "${was_whole} + 20")
            if(beyond GREATER behind OR beyond LESS before)
                message(FATAL_ERROR "microcontroller: ${PAGE} says ${was} where ${is} was found; the target "
                                    "microcontroller_table writes the table.")
            endif()
        endforeach()
    endforeach()
endfunction()

# 20 240 bytes as 20.2
function(kilobytes bytes result)
    math(EXPR tenths "(${bytes} + 50) / 100")
    math(EXPR whole "${tenths} / 10")
    math(EXPR rest "${tenths} % 10")
    set(${result} "${whole}.${rest}" PARENT_SCOPE)
endfunction()

set(table "| TactNet-4, 14 × 25 | | single precision | 8 bits |\n|---|---|---|---|\n")
foreach(processor IN ITEMS cortex-m7 cortex-m4)
    string(REGEX REPLACE "cortex-m" "Cortex-M" name ${processor})
    foreach(level IN ITEMS -Os -O2)
        foreach(form IN ITEMS single_precision eight_bit)
            build_firmware(of SOURCE firmware PROCESSOR ${processor} LEVEL ${level} FORM ${form})
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
               "| ${name}, `${level}` | flash, kB | ${single_precision_flash} | ${eight_bit_flash} |\n"
               "| | RAM with the stack, kB | ${single_precision_ram} | ${eight_bit_ram} |\n"
               "| | thousands of instructions per frame | ${single_precision_thousands} | ${eight_bit_thousands} |\n"
        )
    endforeach()
endforeach()
# A GRU of 16 units for 3 features, frame by frame.
foreach(form IN ITEMS stream stream_eight_bit)
    build_firmware(of SOURCE stream PROCESSOR cortex-m7 LEVEL -Os FORM ${form})
    math(EXPR ram "${of_static} + ${of_stack}")
    message("Cortex-M7 -Os ${form}: flash ${of_flash} bytes, static RAM ${of_static}, stack ${of_stack}, "
            "instructions of a frame ${of_instructions}")
    if(of_flash GREATER 16000 OR ram GREATER 8000)
        message(FATAL_ERROR "microcontroller: expected a stream in at most 16000 bytes of flash and 8000 of RAM, found "
                            "${of_flash} and ${ram}.")
    endif()
endforeach()
# All that decides in the control loop without a network, for 28 × 50 tactels.
foreach(level IN ITEMS -Os -O2)
    build_firmware(of SOURCE decisions PROCESSOR cortex-m7 LEVEL ${level} FORM decisions_expected RAM 65536)
    math(EXPR ram "${of_static} + ${of_stack}")
    message("Cortex-M7 ${level} decisions: flash ${of_flash} bytes, static RAM ${of_static}, stack ${of_stack}, "
            "instructions of a frame ${of_instructions}")
    if(level STREQUAL "-Os" AND (of_flash GREATER 32000 OR ram GREATER 24000))
        message(FATAL_ERROR "microcontroller: expected decisions in at most 32000 bytes of flash and 24000 of RAM, found "
                            "${of_flash} and ${ram}.")
    endif()
endforeach()
message("${table}")
if(EMULATOR)
    compare_with_page("${table}")
endif()
