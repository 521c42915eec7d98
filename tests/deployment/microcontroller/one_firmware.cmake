# build_firmware(...): one program for one processor, and what it takes.

# Bytes of a program's sections, as `size` prints them: text, data, bss.
function(sections_of program result)
    execute_process(COMMAND "${SIZE}" "${program}" OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
    if(NOT output MATCHES "\n *([0-9]+)[ \t]+([0-9]+)[ \t]+([0-9]+)")
        message(FATAL_ERROR "microcontroller: expected sizes from ${SIZE}, found:\n${output}")
    endif()
    set(${result} ${CMAKE_MATCH_1} ${CMAKE_MATCH_2} ${CMAKE_MATCH_3} PARENT_SCOPE)
endfunction()

# build_firmware(prefix PROCESSOR cortex-m7 LEVEL -Os FORM eight_bit): sets <prefix>_flash, <prefix>_static and
# <prefix>_stack in bytes, and <prefix>_instructions of a frame. The last two are 0 without an emulator.
function(build_firmware prefix)
    cmake_parse_arguments(PARSE_ARGV 1 arg "" "PROCESSOR;LEVEL;FORM" "")
    set(unit_cortex-m7 fpv5-sp-d16)
    set(unit_cortex-m4 fpv4-sp-d16)
    set(board_cortex-m7 mps2-an500)
    set(board_cortex-m4 mps2-an386)
    set(options
        -std=c++20 ${arg_LEVEL} -mthumb -mcpu=${arg_PROCESSOR} -mfpu=${unit_${arg_PROCESSOR}} -mfloat-abi=hard
        -fno-exceptions -fno-rtti -ffunction-sections -fdata-sections -Wall -Wextra -Wpedantic -Wconversion -Wshadow
        -Werror "-DTEST_HEADER=\"${arg_FORM}.hpp\"" -DNDEBUG ${OPTIONS} "-I${HEADERS}" "-I${INCLUDE}"
        -nostartfiles -Wl,--gc-sections "-T${SCRIPT}" "${SOURCE}"
    )
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
