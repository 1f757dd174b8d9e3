"""`python -m etalon_bench` is the program `etalon`."""

from ._program import main

if __name__ == "__main__":
    raise SystemExit(main())
