# SPDX-License-Identifier: MIT
"""Gnomon: light glTF scenes with an EEVEE-style engine. doc/python.md has examples.

Units are metres, radians and watts; colours are linear, with Rec. 709 primaries.
"""

from gnomon._gnomon import *
