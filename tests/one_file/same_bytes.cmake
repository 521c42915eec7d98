# Writes the one-file form twice: cmake -DPYTHON=… -DSCRIPT=… -DFOLDER=… -P same_bytes.cmake
cmake_minimum_required(VERSION 3.22)

foreach(time IN ITEMS once twice)
    execute_process(COMMAND "${PYTHON}" "${SCRIPT}" --out "${FOLDER}/${time}" COMMAND_ERROR_IS_FATAL ANY)
endforeach()
foreach(name IN ITEMS tactnet.hpp tactnet_sensors.hpp)
    file(SHA256 "${FOLDER}/once/${name}" once)
    file(SHA256 "${FOLDER}/twice/${name}" twice)
    if(NOT once STREQUAL twice)
        message(SEND_ERROR "${name}: expected the same bytes from the same sources, found others")
    endif()
    # A line that needs a second file would stop a reader who pastes it.
    file(STRINGS "${FOLDER}/once/${name}" own REGEX "^ *# *include +[<\"]tactnet/")
    file(STRINGS "${FOLDER}/once/${name}" head LIMIT_COUNT 12)
    if(own OR NOT head MATCHES "tactnet [0-9]+\\.[0-9]+\\.[0-9]+.*MIT License")
        message(SEND_ERROR "${name}: expected version and licence, and no header of its own beside it; found ${own}")
    endif()
endforeach()

execute_process(
    COMMAND "${PYTHON}" "${SCRIPT}" tactnet/nowhere.hpp --out "${FOLDER}/nowhere.hpp"
    RESULT_VARIABLE result
    ERROR_VARIABLE message
)
if(result EQUAL 0 OR NOT message MATCHES "found no 'tactnet/nowhere.hpp'")
    message(SEND_ERROR "a header that there is not: expected a refusal, found ${result}: ${message}")
endif()
