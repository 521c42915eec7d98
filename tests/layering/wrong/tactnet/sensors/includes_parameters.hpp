#pragma once

#include <tactnet/io/file.hpp>
#include <tactnet/io/parameters.hpp>
