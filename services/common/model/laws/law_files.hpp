// What every law file includes. A law is one file here: laws/NAME.cpp defines `Law NAME()` (or, where several forms
// share an id, `Law NAME()` for each file); the build makes the catalogue from the file names.
#pragma once

#include "sealwatch/model/laws.hpp"
#include "sealwatch/model/physics.hpp"
