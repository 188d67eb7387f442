"""A search on a cluster gives the bits of one process, also when a worker is killed."""

import os
from dataclasses import replace

import numpy as np
import pytest

import design_problems
from chromanoise.apps.design.pareto_front import Evaluated
from chromanoise.apps.design.search import SearchOptions, scheduler_at, searched_front
from dear import dear
from design_problems import bnh, same
from outcomes import refused_input

SETTINGS = SearchOptions(budget=300, population=50, seed=1)


def sent(problem):
    """The problem with functions that a worker without this folder can decode."""
    cloudpickle = pytest.importorskip("cloudpickle", reason="dask is an extra")
    cloudpickle.register_pickle_by_value(design_problems)
    return problem


@pytest.mark.evidence
@pytest.mark.parametrize("threads", [7, *dear(1, 2, 60)])
def test_a_cluster_gives_the_front_of_one_process_whatever_the_chunks(cluster_address, threads):
    here = searched_front(bnh(), SETTINGS)
    with scheduler_at(cluster_address) as two:
        assert two.threads == 2
        there = searched_front(sent(bnh()), SETTINGS, evaluate_on=replace(two, threads=threads))
        assert same(there, here)


def test_a_worker_that_is_killed_changes_no_bit(cluster_address, kill_one):
    here = searched_front(bnh(), SETTINGS)
    with scheduler_at(cluster_address) as two:
        there = searched_front(sent(bnh()), SETTINGS, evaluate_on=two, progress=kill_one)
    assert same(there, here)


def test_a_nan_from_a_worker_is_the_same_sentence(cluster_address):
    def spoiled(values):
        return Evaluated(
            objectives=np.where(values[:, :1] > 4, np.nan, values), violation=values - 9.0
        )

    problem, found = replace(bnh(), evaluate=spoiled), []
    with scheduler_at(cluster_address) as two:
        for place in (None, two):
            with refused_input(subject="the objective f1") as refused:
                searched_front(problem, SETTINGS, evaluate_on=place)
            found.append(str(refused.value))
    assert found[0] == found[1]


@pytest.mark.evidence
def test_lost_workers_are_one_sentence_that_names_the_population():
    dask = pytest.importorskip("dask", reason="dask is an extra")

    def ended(values):
        os._exit(1)

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        refused_input(setting="population", requirement="KilledWorker"),
        scheduler_at("local", workers=1) as one,
    ):
        searched_front(replace(bnh(), evaluate=ended), SETTINGS, evaluate_on=one)
