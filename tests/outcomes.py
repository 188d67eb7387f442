"""What a command told: its complaints have one form."""


def refused(outcome, *parts):
    """Exit code 2 and one sentence that holds ``parts``, nothing else."""
    code, out, err = outcome
    assert code == 2
    assert out == ""
    assert err.startswith("chromanoise: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    for part in parts:
        assert part in err
