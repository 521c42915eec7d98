# Puts the results of `tactnet study` into the documentation: its tables into docs/verify/study, its picture into docs/pictures, and the
# tables between the comments of docs/choosing.md and docs/verify/results.md that name them. Tables that are not in study.md are rows and
# columns of its table of all methods. README.md quotes some figures: they are compared.
#
#   cmake -DRESULTS=folder -DARCHIVE=file -P docs/verify/study/tables.cmake   takes over a folder of results; all rows, trainings
#                                   and timings go into the archive, such as benchmarks/results/zen5/2026-11-24/study.tar.xz
#   cmake -P docs/verify/study/tables.cmake                                   writes the tables into the pages again
#   cmake -DCHECK=ON -P docs/verify/study/tables.cmake                        fails if pages and docs/verify/study differ
#   cmake -DCHECK=ON -DROOT=folder -P …                                the same for another copy of the project

cmake_minimum_required(VERSION 3.22)
if(NOT ROOT)
    get_filename_component(ROOT "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
endif()
set(kept "${ROOT}/docs/verify/study")
if(RESULTS OR ARCHIVE)
    if(NOT EXISTS "${RESULTS}/study.md" OR NOT ARCHIVE)
        message(FATAL_ERROR "tables.cmake: expected RESULTS, a folder in which tactnet study wrote study.md, and ARCHIVE, "
                            "a file to write, found '${RESULTS}' and '${ARCHIVE}'.")
    endif()
    file(COPY "${RESULTS}/study.csv" DESTINATION "${kept}")
    file(READ "${RESULTS}/study.md" page)
    string(REGEX REPLACE "\n!\\[[^\n]*\n\n[^\n]*\n" "" page "${page}") # docs/pictures has pictures in the pages' style
    file(WRITE "${kept}/study.md" "${page}")
    get_filename_component(archive "${ARCHIVE}" ABSOLUTE)
    execute_process(
        COMMAND "${CMAKE_COMMAND}" -E tar cJf "${archive}" --format=gnutar evaluation.jsonl timings.jsonl study.jsonl
        WORKING_DIRECTORY "${RESULTS}" RESULT_VARIABLE status
    )
    if(NOT status EQUAL 0)
        message(FATAL_ERROR "tables.cmake: ${archive} could not be written.")
    endif()
    execute_process(COMMAND "${ROOT}/scripts/pictures" accuracy_and_time COMMAND_ERROR_IS_FATAL ANY)
endif()

# The text between the comments `<!-- study NAME -->` and `<!-- study NAME ends -->`, both included.
function(block_of file name result)
    file(READ "${file}" text)
    set(begin "<!-- study ${name} -->")
    set(end "<!-- study ${name} ends -->")
    string(FIND "${text}" "${begin}" first)
    string(FIND "${text}" "${end}" last)
    if(first LESS 0 OR last LESS first)
        message(FATAL_ERROR "tables.cmake: ${file}: expected '${begin}' and after it '${end}', found only one of them, or none.")
    endif()
    string(LENGTH "${end}" length)
    math(EXPR length "${last} + ${length} - ${first}")
    string(SUBSTRING "${text}" ${first} ${length} block)
    set(${result} "${block}" PARENT_SCOPE)
endfunction()

# Chosen columns of the rows of the table of all methods for which `select(cells keep)` sets `keep`. The columns, from 1: method, tactels,
# recipe, random splits, the same with reflections averaged, blocked splits, paper, µs, p99, ms of the paper, parameters, multiply-adds,
# training.
function(rows_of select columns result)
    block_of("${kept}/study.md" methods text)
    string(REPLACE "\n" ";" lines "${text}")
    set(rows "")
    foreach(line IN LISTS lines)
        if(NOT line MATCHES "^\\| [a-z]" OR line MATCHES "^\\| method ")
            continue()
        endif()
        string(REPLACE "|" ";" cells "${line}")
        set(keep FALSE)
        cmake_language(CALL ${select} "${cells}" keep)
        if(keep)
            set(row "|")
            foreach(column IN LISTS columns)
                list(GET cells ${column} cell)
                string(APPEND row "${cell}|")
            endforeach()
            string(APPEND rows "${row}\n")
        endif()
    endforeach()
    if(rows STREQUAL "")
        message(FATAL_ERROR "tables.cmake: ${kept}/study.md: expected rows for ${select}, found no row.")
    endif()
    set(${result} "${rows}" PARENT_SCOPE)
endfunction()
function(is_wanted cells result)
    list(SUBLIST cells 1 3 key)
    string(COMPARE EQUAL "${key}" "${wanted}" equal)
    set(${result} ${equal} PARENT_SCOPE)
endfunction()
function(is_compared cells result)
    list(GET cells 4 random)
    list(GET cells 7 paper)
    set(${result} FALSE PARENT_SCOPE)
    if(NOT random STREQUAL " " AND NOT paper STREQUAL " ")
        set(${result} TRUE PARENT_SCOPE)
    endif()
endfunction()

# The table of a name, between its comments.
function(table name result)
    if(name STREQUAL "best")
        set(head "| method | tactels | recipe | random splits, % | blocked splits, % | µs per frame | parameters |")
        set(rows "")
        foreach(
            row IN
            ITEMS "tactnet4 in 8 bits | 7 × 13 | default" "tactnet6-economical | 14 × 25 | default"
                  "tactnet6 | 28 × 50 | default" "tactnet6 | 28 × 50 | thorough"
                  "squeezenet-pooled-svm | 28 × 50 | default"
        )
            string(REPLACE "|" ";" wanted " ${row} ")
            rows_of(is_wanted "1;2;3;4;6;8;11" found)
            string(APPEND rows "${found}")
        endforeach()
    elseif(name STREQUAL "compared")
        set(head "| method | tactels | recipe | paper, % | tactnet, % |")
        rows_of(is_compared "1;2;3;7;4" rows)
    else()
        block_of("${kept}/study.md" "${name}" block)
        set(${result} "${block}" PARENT_SCOPE)
        return()
    endif()
    string(REGEX REPLACE "[^|]+" " --- " rule "${head}")
    set(${result} "<!-- study ${name} -->\n${head}\n${rule}\n${rows}<!-- study ${name} ends -->" PARENT_SCOPE)
endfunction()

foreach(place IN ITEMS docs/choosing.md:front docs/verify/results.md:best docs/verify/results.md:compared docs/verify/results.md:memory)
    string(REPLACE ":" ";" place "${place}")
    list(GET place 0 page)
    list(GET place 1 name)
    table("${name}" new)
    block_of("${ROOT}/${page}" "${name}" old)
    if(old STREQUAL new)
        continue()
    endif()
    if(CHECK)
        message(FATAL_ERROR "tables.cmake: ${page}: the table '${name}' differs from docs/verify/study/study.md; "
                            "run docs/verify/study/tables.cmake.")
    endif()
    file(READ "${ROOT}/${page}" text)
    string(REPLACE "${old}" "${new}" text "${text}")
    file(WRITE "${ROOT}/${page}" "${text}")
    message(STATUS "${page}: table '${name}'")
endforeach()

# README.md quotes the first and the last row of the front, and the microcontroller of docs/recognise/eight_bit.md.
file(READ "${kept}/study.md" study)
file(READ "${ROOT}/docs/recognise/eight_bit.md" eight_bit)
file(READ "${ROOT}/README.md" readme)
# Each of the quotes, in which `<n>` is the n-th group of the pattern, must be in README.md.
function(expect_in_readme text pattern)
    if(NOT text MATCHES "${pattern}")
        message(FATAL_ERROR "tables.cmake: expected a row '${pattern}' for README.md, found none.")
    endif()
    foreach(quote IN LISTS ARGN)
        foreach(group RANGE 1 ${CMAKE_MATCH_COUNT})
            string(REPLACE "<${group}>" "${CMAKE_MATCH_${group}}" quote "${quote}")
        endforeach()
        string(FIND "${readme}" "${quote}" position)
        if(position EQUAL -1)
            message(FATAL_ERROR "tables.cmake: README.md: expected '${quote}', as the tables have it, found none.")
        endif()
    endforeach()
endfunction()
expect_in_readme(
    "${study}" "\n[|] tactnet6, thorough recipe [|] 28 × 50 [|] ([0-9.]+) [|] ([0-9.]+) ± ([0-9.]+) [(]20[)] [|] ([0-9.]+) ± ([0-9.]+) "
    "TactNet-6 takes <1> µs per frame" "TactNet-6 recognises <2> %" "<2> ± <3> %" "<4> ± <5> %"
)
expect_in_readme("${study}" "\n[|] tactnet4 in 8 bits [|] 7 × 13 [|] ([0-9.]+) " "the smallest network <1> µs")
expect_in_readme(
    "${eight_bit}" "Cortex-M7, `-Os` [|] flash, kB [|] [0-9.]+ [|] ([0-9.]+) [|]\n[|] [|] RAM[^|]*[|] [0-9.]+ [|] ([0-9.]+) [|]"
    "<1> kB of flash and <2> kB of RAM on an emulated Cortex-M7"
)
