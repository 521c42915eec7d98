#pragma once

// The methods that were compiled in.

#include "methods/method.hpp"

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// All of them, networks by name and then by size in front. Generated when configuring.
std::vector<std::unique_ptr<method>> make_methods();

/// The same, made once.
const std::vector<std::unique_ptr<method>>& all_methods();

/// Throws usage_error with what there is.
const method& find_method(std::string_view name, std::size_t rows, std::size_t columns);

/// Throws tactnet::file_error when a data folder has more classes than the method.
void check_capacity(const method& what, const std::string& data, std::size_t classes);

/// The method that is trained unless the user names one.
std::string default_method();

/// Each once: "tactnet4, tactnet6, …".
std::string method_names();
