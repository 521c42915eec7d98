#pragma once

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/checksum.hpp>
#include <tactnet/io/element_type.hpp>
#include <tactnet/io/file.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/image_folder.hpp>
#include <tactnet/io/json_checksum.hpp>
#include <tactnet/io/json_scanner.hpp>
#include <tactnet/io/model_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/parameters.hpp>
#include <tactnet/io/partial_file.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/io/safetensors_header.hpp>
#include <tactnet/io/safetensors_writer.hpp>
#include <tactnet/io/text.hpp>
