#pragma once

#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/resistive_network.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/simulation/objects/part.hpp>
#include <tactnet/simulation/paper/objects.hpp>
#include <tactnet/simulation/scene.hpp>
