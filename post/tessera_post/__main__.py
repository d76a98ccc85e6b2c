"""python -m tessera_post: the same as tessera-post."""

import sys

from tessera_post.cli import main

sys.exit(main())
