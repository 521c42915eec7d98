# A deployed frame runs without dispatch: no call or jump in its object code goes where a register or a place in memory
# says, and nothing outside the object is called but what copies and clears memory: no heap, no lock, no operating
# system.
#
# cmake -DOBJDUMP=objdump -DNM=nm -DFRAMES=<object of frames.cpp> -DDISPATCHES=<object of dispatches.cpp>
#       -DFUNCTIONS=<how many frames.cpp has> -P check.cmake
cmake_minimum_required(VERSION 3.22)

# Calls and jumps by register or memory, as x86 and 64-bit ARM have them.
set(indirect "[ \t](call|jmp)q?[ \t]+\\*|[ \t](blr|br|blraa|braa)[ \t]+x[0-9]+")
# Copying and clearing memory; what a call that must not throw refers to in case it did.
set(harmless "^(memcpy|memmove|memset|__gxx_personality_v0|_ZSt9terminatev|__cxa_begin_catch|_GLOBAL_OFFSET_TABLE_|DW\\.ref\\.__gxx_personality_v0)$")

# Lines that dispatch, and names that are called outside.
function(examine object dispatching outside)
    execute_process(
        COMMAND "${OBJDUMP}" --disassemble --no-show-raw-insn "${object}"
        OUTPUT_VARIABLE code COMMAND_ERROR_IS_FATAL ANY
    )
    string(REGEX MATCHALL "[^\n]*(${indirect})[^\n]*" lines "${code}")
    execute_process(
        COMMAND "${NM}" --undefined-only --format=posix "${object}" OUTPUT_VARIABLE names COMMAND_ERROR_IS_FATAL ANY
    )
    string(REGEX MATCHALL "[^\n]+" names "${names}")
    list(TRANSFORM names REPLACE " .*" "")
    list(FILTER names EXCLUDE REGEX "${harmless}")
    set(${dispatching} "${lines}" PARENT_SCOPE)
    set(${outside} "${names}" PARENT_SCOPE)
endfunction()

# What would be found.
examine("${DISPATCHES}" lines names)
if(NOT lines)
    message(FATAL_ERROR "${DISPATCHES}: a virtual call was not found: this would prove nothing")
endif()
foreach(name IN ITEMS "^_Znw" "mutex_lock")
    set(found "${names}")
    list(FILTER found INCLUDE REGEX "${name}")
    if(NOT found)
        message(FATAL_ERROR "${DISPATCHES}: '${name}' was not found among ${names}: this would prove nothing")
    endif()
endforeach()

execute_process(
    COMMAND "${NM}" --defined-only --extern-only --format=posix "${FRAMES}"
    OUTPUT_VARIABLE defined COMMAND_ERROR_IS_FATAL ANY
)
string(REGEX MATCHALL "frame_of_[^\n]* T " functions "${defined}")
list(LENGTH functions count)
if(NOT count EQUAL FUNCTIONS)
    message(FATAL_ERROR "${FRAMES}: expected ${FUNCTIONS} frames, found ${count}: ${functions}")
endif()
examine("${FRAMES}" lines names)
if(lines)
    list(JOIN lines "\n" lines)
    message(FATAL_ERROR "${FRAMES}: calls or jumps by register or memory:\n${lines}")
endif()
if(names)
    message(FATAL_ERROR "${FRAMES}: expected no call out of the object, found ${names}")
endif()
message("${count} frames without dispatch, and without a call to anything else")
