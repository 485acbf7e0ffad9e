"""How big may the communication step be?"""
