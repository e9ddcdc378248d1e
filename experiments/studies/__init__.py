"""The studies, one per question, in folders by subject."""
