#include "panorama/resample.h"
