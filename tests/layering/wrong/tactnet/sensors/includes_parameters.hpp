#pragma once

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/parameters.hpp>
