"""python3 -m spikeloop.bench, which `spikeloop bench` starts."""

import sys

from .command import main

sys.exit(main())
