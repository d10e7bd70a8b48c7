"""`python -m punchform` is the command `punchform`."""

import sys

from punchform.cli import main

sys.exit(main())
