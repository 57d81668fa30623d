"""`python -m app` is `bohemia`."""

import sys

from app.cli import main

sys.exit(main())
